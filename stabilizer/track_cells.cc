// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/track_cells.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace rsstab::stabilizer {
namespace {

constexpr int kCellRows = 12;
constexpr int kCellColumns = 4;
constexpr std::size_t kMinTracks = 20;
constexpr int kRobustRounds = 8;
// Tracks are no better than this, at 640 px width.
constexpr double kMinScatter = 0.05 / 640.0;
// A cell with less than one good track among its own is left out.
constexpr double kMinCellWeight = 0.7;
constexpr double kInlierWeight = 0.25;

struct PlaneTrack {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  double from_row_share;
  double to_row_share;
};

// Pixels of the tracks' size -> picture widths from the principal point.
class PlaneFromPixels {
 public:
  PlaneFromPixels(const PointTracks& tracks, const Camera* lens) {
    if (lens != nullptr) {
      camera_ = lens->Rescaled(tracks.width, tracks.height);
    }
    middle_ = Eigen::Vector2d(0.5 * (tracks.width - 1), 0.5 * (tracks.height - 1));
    width_ = tracks.width;
  }

  [[nodiscard]] std::optional<Eigen::Vector2d> operator()(const Eigen::Vector2f& pixel) const {
    if (!camera_) {
      return (pixel.cast<double>() - middle_) / width_;
    }
    const auto ray = camera_->UnprojectPixel(pixel.cast<double>());
    if (!ray) {
      return std::nullopt;
    }
    return Eigen::Vector2d(ray->hnormalized() * (camera_->fx / width_));
  }

 private:
  std::optional<Camera> camera_;
  Eigen::Vector2d middle_;
  double width_;
};

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

FramePairCells SummarizeTracks(const PointTracks& tracks, const Camera* lens) {
  FramePairCells pair;
  pair.from_time_s = tracks.from_time_s;
  pair.to_time_s = tracks.to_time_s;
  const PlaneFromPixels plane(tracks, lens);
  std::vector<PlaneTrack> all;
  all.reserve(tracks.matches.size());
  for (const PointMatch& m : tracks.matches) {
    const auto from = plane(m.from);
    const auto to = plane(m.to);
    if (from && to) {
      all.push_back({*from, *to, (static_cast<double>(m.from.y()) + 0.5) / tracks.height - 0.5,
                     (static_cast<double>(m.to.y()) + 0.5) / tracks.height - 0.5});
    }
  }
  if (all.size() < kMinTracks) {
    return pair;
  }

  // Iteratively reweighted affine fit (Geman-McClure): an object that fills less than half of the
  // picture does not pull it.
  std::vector<double> weights(all.size(), 1.0);
  std::vector<double> distances(all.size());
  for (int round = 0; round < kRobustRounds; ++round) {
    Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Eigen::Vector3d basis(1.0, all[i].from.x(), all[i].from.y());
      normal += weights[i] * basis * basis.transpose();
      right += weights[i] * basis * (all[i].to - all[i].from).transpose();
    }
    pair.affine = normal.ldlt().solve(right).transpose();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Eigen::Vector3d basis(1.0, all[i].from.x(), all[i].from.y());
      distances[i] = (all[i].to - all[i].from - pair.affine * basis).norm();
    }
    pair.scatter = std::max(1.48 * Median(distances), kMinScatter);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double share = distances[i] / (2.0 * pair.scatter);
      weights[i] = 1.0 / ((1.0 + share * share) * (1.0 + share * share));
    }
  }

  // Both ends are averaged with the same weights, so that for an affine motion the mean of the ends
  // is again a true pair, wherever in its cell the tracks lie.
  struct Sum {
    PlaneTrack weighted{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), 0.0, 0.0};
    double weight = 0.0;
  };
  std::array<Sum, kCellRows * kCellColumns> sums;
  const double half_height = 0.5 * tracks.height / tracks.width;
  for (std::size_t i = 0; i < all.size(); ++i) {
    pair.num_inliers += weights[i] > kInlierWeight ? 1 : 0;
    const double across = all[i].from.x() + 0.5;
    const double down = 0.5 * (all[i].from.y() / half_height + 1.0);
    const int column = std::clamp(static_cast<int>(across * kCellColumns), 0, kCellColumns - 1);
    const int row = std::clamp(static_cast<int>(down * kCellRows), 0, kCellRows - 1);
    Sum& sum = sums[static_cast<std::size_t>(row * kCellColumns + column)];
    sum.weight += weights[i];
    sum.weighted.from += weights[i] * all[i].from;
    sum.weighted.to += weights[i] * all[i].to;
    sum.weighted.from_row_share += weights[i] * all[i].from_row_share;
    sum.weighted.to_row_share += weights[i] * all[i].to_row_share;
  }
  for (const Sum& sum : sums) {
    if (sum.weight >= kMinCellWeight) {
      pair.cells.push_back({sum.weighted.from / sum.weight, sum.weighted.to / sum.weight,
                            sum.weighted.from_row_share / sum.weight,
                            sum.weighted.to_row_share / sum.weight, sum.weight});
    }
  }
  return pair;
}

}  // namespace rsstab::stabilizer
