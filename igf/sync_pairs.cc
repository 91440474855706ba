// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_pairs.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "igf/base/rolling_shutter.h"

namespace rsstab::igf {
namespace {

// Farther off the axis, a pixel of noise is too many degrees on the image plane (and a calibration
// less sure).
constexpr double kMaxPlaneRadius = 1.75;  // 60 degrees
constexpr double kDerivativeStep = 1e-5;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<Eigen::Vector2d> ToPlane(const CameraProjector& lens, const Eigen::Vector2d& pixel) {
  if (!pixel.allFinite()) {
    return std::nullopt;
  }
  const auto ray = lens.UnprojectPixel(pixel);
  if (!ray || !(ray->head<2>().norm() < kMaxPlaneRadius)) {
    return std::nullopt;
  }
  return ray->head<2>();
}

// Geometric mean of the two scales of plane -> pixels.
std::optional<double> PxPerUnit(const CameraProjector& lens, const Eigen::Vector2d& plane) {
  Eigen::Matrix2d jacobian;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kDerivativeStep * Eigen::Vector2d::Unit(axis);
    const auto high = lens.ProjectRay((plane + step).homogeneous());
    const auto low = lens.ProjectRay((plane - step).homogeneous());
    if (!high || !low) {
      return std::nullopt;
    }
    jacobian.col(axis) = (*high - *low) / (2.0 * kDerivativeStep);
  }
  return std::sqrt(std::abs(jacobian.determinant()));
}

std::optional<SyncMatch> PrepareMatch(const CameraProjector& lens, const PointMatch& match,
                                      int width, int height) {
  const auto from = ToPlane(lens, match.from.cast<double>());
  const auto to = ToPlane(lens, match.to.cast<double>());
  if (!from || !to) {
    return std::nullopt;
  }
  const auto scale = PxPerUnit(lens, *to);
  if (!scale) {
    return std::nullopt;
  }
  const auto row_share = [height](float row) {
    return RowExposureTime(0.0, static_cast<double>(row), height, 1.0);
  };
  const double column_share = (static_cast<double>(match.from.x()) + 0.5) / width - 0.5;
  return SyncMatch{*from,        *to,   row_share(match.from.y()), row_share(match.to.y()),
                   column_share, *scale};
}

}  // namespace

Result<std::vector<SyncPair>> PrepareSyncPairs(std::span<const PointTracks> tracks,
                                               const Camera& camera, std::size_t min_matches,
                                               std::size_t max_matches) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "gyro synchronisation");
  }
  std::vector<SyncPair> pairs;
  if (tracks.empty()) {
    return pairs;
  }
  const int width = tracks.front().width;
  const int height = tracks.front().height;
  if (width < 1 || height < 1) {
    return Fail(ErrorCode::kInvalidArgument, "tracks in an image of {}x{} pixels", width, height);
  }
  const CameraProjector lens(camera.Rescaled(width, height));
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const PointTracks& source = tracks[i];
    if (source.width != width || source.height != height) {
      return Fail(ErrorCode::kInvalidArgument,
                  "tracks of frame pair {} are stated for {}x{} pixels, those before for {}x{}", i,
                  source.width, source.height, width, height);
    }
    if (!(source.to_time_s > source.from_time_s) || !std::isfinite(source.to_time_s)) {
      continue;
    }
    SyncPair pair{source.from_time_s, source.to_time_s, {}, Eigen::Vector2d::Zero()};
    const std::size_t stride = std::max<std::size_t>(
        1, (source.matches.size() + max_matches - 1) / std::max<std::size_t>(max_matches, 1));
    std::vector<double> dx;
    std::vector<double> dy;
    for (std::size_t k = 0; k < source.matches.size(); k += stride) {
      const PointMatch& match = source.matches[k];
      if (const auto prepared = PrepareMatch(lens, match, width, height)) {
        pair.matches.push_back(*prepared);
        dx.push_back(static_cast<double>(match.to.x()) - static_cast<double>(match.from.x()));
        dy.push_back(static_cast<double>(match.to.y()) - static_cast<double>(match.from.y()));
      }
    }
    if (pair.matches.size() < std::max<std::size_t>(min_matches, 1)) {
      continue;
    }
    pair.median_motion_px = {Median(std::move(dx)), Median(std::move(dy))};
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

std::vector<SyncPair> SelectInformativePairs(std::span<const SyncPair> pairs, std::size_t count) {
  if (pairs.size() <= count) {
    return {pairs.begin(), pairs.end()};
  }
  std::vector<double> change(pairs.size(), 0.0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector2d& before = pairs[i > 0 ? i - 1 : i].median_motion_px;
    const Eigen::Vector2d& after = pairs[std::min(i + 1, pairs.size() - 1)].median_motion_px;
    change[i] = (2.0 * pairs[i].median_motion_px - before - after).norm();
  }
  const auto by_change = [&](std::size_t a, std::size_t b) {
    return change[a] != change[b] ? change[a] > change[b] : a < b;
  };
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), by_change);
  std::vector<bool> taken(pairs.size(), false);
  const std::size_t strongest = count / 2;
  for (std::size_t i = 0; i < strongest; ++i) {
    taken[order[i]] = true;
  }
  // The other half evenly over the clip: the strongest of what is left in every stretch.
  const std::size_t stretches = count - strongest;
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t begin = s * pairs.size() / stretches;
    const std::size_t end = (s + 1) * pairs.size() / stretches;
    std::size_t best = end;
    for (std::size_t i = begin; i < end; ++i) {
      if (!taken[i] && (best == end || by_change(i, best))) {
        best = i;
      }
    }
    if (best < end) {
      taken[best] = true;
    }
  }
  std::vector<SyncPair> selected;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (taken[i]) {
      selected.push_back(pairs[i]);
    }
  }
  return selected;
}

}  // namespace rsstab::igf
