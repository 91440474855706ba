// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/track_cells.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "igf/base/seeded_random.h"

namespace rsstab::stabilizer {
namespace {

// A frame whose cells move less than this, RMS, repeats the one before. Repeats that were encoded
// again have 0.01 to 0.03 px; a hand moves a camera by a hundred times that.
constexpr double kRepeatMotion = 0.05 / 640.0;
constexpr int kCellRows = 12;
constexpr int kCellColumns = 4;
constexpr std::size_t kMinTracks = 20;
// Reweighted rounds: an affine motion first, then with the bends of kSmooth.
constexpr int kAffineRounds = 5;
constexpr int kSmoothRounds = 4;
constexpr std::size_t kMinSmoothTracks = 60;
// Least median of squares: with 40% of wrong tracks one triple in five is right, and all 48 are
// wrong once in 10^5 times. The median of so many tracks is good enough to choose by.
constexpr int kTriples = 48;
constexpr std::size_t kJudges = 96;
constexpr double kMinTripleArea = 0.01;  // twice the triangle's, in squared picture widths
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

// A motion that varies smoothly over the picture: affine, or with what the perspective of a turn
// and a rolling shutter bend. Tracks of a camera that turns are no outliers of an affine motion;
// weighted as such, they would make every lens look 4% longer.
constexpr int kAffine = 3;
constexpr int kSmooth = 8;
using Basis = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSmooth, 1>;
using Motion = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kSmooth>;  // to - from by basis

Basis BasisAt(const Eigen::Vector2d& from, Eigen::Index size) {
  const double x = from.x();
  const double y = from.y();
  Eigen::Matrix<double, kSmooth, 1> all;
  all << 1.0, x, y, x * x, x * y, y * y, x * y * y, y * y * y;
  return all.head(size);
}

double Distance(const PlaneTrack& track, const Motion& motion) {
  return (track.to - track.from - motion * BasisAt(track.from, motion.cols())).norm();
}

Motion WeightedFit(const std::vector<PlaneTrack>& all, const std::vector<double>& weights,
                   Eigen::Index size) {
  using Normal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSmooth, kSmooth>;
  Normal normal = 1e-9 * Normal::Identity(size, size);
  Motion right = Motion::Zero(2, size);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Basis basis = BasisAt(all[i].from, size);
    normal.noalias() += weights[i] * basis * basis.transpose();
    right.noalias() += weights[i] * (all[i].to - all[i].from) * basis.transpose();
  }
  return normal.ldlt().solve(right.transpose()).transpose();
}

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The affine motion of three tracks that most tracks agree with (P. Rousseeuw 1984). A fit to all
// of them would take an object at one side for a stretch of the picture, and stay there.
Motion MotionOfMost(const std::vector<PlaneTrack>& all) {
  SeededRandom random(1);
  const std::size_t num_judges = std::min(all.size(), kJudges);
  std::vector<double> distances(num_judges);
  Motion best = Motion::Zero(2, kAffine);
  double best_distance = std::numeric_limits<double>::infinity();
  for (int triple = 0; triple < kTriples; ++triple) {
    Eigen::Matrix3d basis;
    Eigen::Matrix<double, 3, 2> motion;
    for (int i = 0; i < 3; ++i) {
      const PlaneTrack& track =
          all[static_cast<std::size_t>(random.Integer(0, static_cast<int>(all.size()) - 1))];
      basis.row(i) << 1.0, track.from.transpose();
      motion.row(i) = (track.to - track.from).transpose();
    }
    Motion affine = Motion::Zero(2, kAffine);  // of three tracks on a line: the mean shift
    affine.col(0) = motion.colwise().mean();
    if (std::abs(basis.determinant()) > kMinTripleArea) {
      affine = basis.inverse().lazyProduct(motion).transpose();
    }
    for (std::size_t i = 0; i < num_judges; ++i) {
      distances[i] = Distance(all[i * all.size() / num_judges], affine);
    }
    if (const double distance = Median(distances); distance < best_distance) {
      best_distance = distance;
      best = affine;
    }
  }
  return best;
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

  // Iteratively reweighted fit (Geman-McClure), from the motion that most tracks share: an
  // object that fills less than half of the picture does not pull it.
  std::vector<double> weights(all.size());
  std::vector<double> distances(all.size());
  Motion motion = MotionOfMost(all);
  const int rounds = kAffineRounds + (all.size() < kMinSmoothTracks ? 0 : kSmoothRounds);
  for (int round = 0;; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      distances[i] = Distance(all[i], motion);
    }
    std::vector<double> ordered = distances;
    pair.scatter = std::max(1.48 * Median(ordered), kMinScatter);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double share = distances[i] / (2.0 * pair.scatter);
      weights[i] = 1.0 / ((1.0 + share * share) * (1.0 + share * share));
    }
    if (round == rounds) {
      break;
    }
    motion = WeightedFit(all, weights, round < kAffineRounds ? kAffine : kSmooth);
  }
  pair.affine = WeightedFit(all, weights, kAffine);

  // Both ends are averaged with the same weights: where the smooth motion is affine, the mean of
  // the ends is again a true pair, wherever in its cell the tracks lie; where it bends, what
  // differs between the mean of the motion and the motion of the mean is put right.
  struct Sum {
    PlaneTrack weighted{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), 0.0, 0.0};
    Basis basis = Basis::Zero(kSmooth);
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
    sum.basis.head(motion.cols()) += weights[i] * BasisAt(all[i].from, motion.cols());
    sum.weight += weights[i];
    sum.weighted.from += weights[i] * all[i].from;
    sum.weighted.to += weights[i] * all[i].to;
    sum.weighted.from_row_share += weights[i] * all[i].from_row_share;
    sum.weighted.to_row_share += weights[i] * all[i].to_row_share;
  }
  for (const Sum& sum : sums) {
    if (sum.weight >= kMinCellWeight) {
      const Eigen::Vector2d from = sum.weighted.from / sum.weight;
      const Eigen::Vector2d bend =
          motion * (BasisAt(from, motion.cols()) - sum.basis.head(motion.cols()) / sum.weight);
      pair.cells.push_back({from, sum.weighted.to / sum.weight + bend,
                            sum.weighted.from_row_share / sum.weight,
                            sum.weighted.to_row_share / sum.weight, sum.weight});
    }
  }
  return pair;
}

bool IsRepeat(const FramePairCells& pair) {
  double sum_sq = 0.0;
  for (const TrackCell& cell : pair.cells) {
    sum_sq += (cell.to - cell.from).squaredNorm();
  }
  return !pair.cells.empty() &&
         sum_sq < kRepeatMotion * kRepeatMotion * static_cast<double>(pair.cells.size());
}

}  // namespace rsstab::stabilizer
