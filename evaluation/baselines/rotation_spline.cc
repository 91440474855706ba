// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/rotation_spline.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "evaluation/baselines/neighbour_tracks.h"
#include "evaluation/baselines/rotation_spline_residuals.h"
#include "evaluation/field_reference.h"
#include "igf/base/readout_motion.h"

namespace rsstab::evaluation {
namespace {

constexpr std::size_t kLeastTracks = 30;
// Key rotations per frame interval: from and to of a track, an interval apart, are then never
// between the same two keys.
constexpr int kKeysPerInterval = 8;
constexpr double kLoss_px = 1.0;
// A key 0.003 rad off its neighbours' middle costs as much as a track that is one pixel off. Motion
// that repeats from frame to frame moves no track: with less weight, noise grows in it without
// bound.
constexpr double kBendWeight = 300.0;

using Key = std::array<double, 3>;

// Key rotations over a span of time in frame intervals.
class Spline {
 public:
  Spline(double begin, double end)
      : begin_(begin),
        keys_(static_cast<std::size_t>(std::ceil((end - begin) * kKeysPerInterval)) + 2, Key{}) {}

  struct Place {
    std::size_t key;  // the one before
    double share;     // of the way to the next
  };
  [[nodiscard]] Place At(double time) const {
    const double position =
        std::clamp((time - begin_) * kKeysPerInterval, 0.0, static_cast<double>(keys_.size() - 1));
    const auto key = std::min(static_cast<std::size_t>(position), keys_.size() - 2);
    return {key, position - static_cast<double>(key)};
  }
  [[nodiscard]] Eigen::Quaterniond Orientation(double time) const {
    const Place place = At(time);
    return BetweenKeys(keys_[place.key].data(), keys_[place.key + 1].data(), place.share);
  }
  [[nodiscard]] std::vector<Key>& keys() { return keys_; }

 private:
  double begin_;
  std::vector<Key> keys_;
};

void AddTracks(const PointTracks& tracks, const Camera& camera, double readout, Spline& spline,
               ceres::Problem& problem) {
  const Eigen::Matrix3d k_inverse = camera.K().inverse();
  for (const PointMatch& match : tracks.matches) {
    const auto from = spline.At(tracks.FromExposureTime(match, readout));
    const auto to = spline.At(tracks.ToExposureTime(match, readout));
    if (to.key < from.key + 2) {
      continue;  // a wild match: its rows are hardly exposed one after the other
    }
    auto* functor = new SplineTrackResidual(
        k_inverse * match.from.cast<double>().homogeneous(), from.share,
        k_inverse * match.to.cast<double>().homogeneous(), to.share, camera.fx);
    auto& keys = spline.keys();
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SplineTrackResidual, 4, 3, 3, 3, 3>(functor),
        new ceres::CauchyLoss(kLoss_px), keys[from.key].data(), keys[from.key + 1].data(),
        keys[to.key].data(), keys[to.key + 1].data());
  }
}

}  // namespace

Result<MethodAnswer> RotationSplineMethod::Estimate(const MethodInput& input) {
  if (input.camera == nullptr || !input.camera->readout_s || !(input.frame_interval_s > 0.0) ||
      input.camera->model != LensModel::kPinhole) {
    return Fail(ErrorCode::kUnsupported,
                "the picture's lens (a pinhole), readout time or frame interval is not known");
  }
  const auto pairs = TrackNeighbours(input, kLeastTracks);
  if (!pairs) {
    return Propagate(pairs.error());
  }
  const PointTracks& any = pairs->front();
  const Camera camera = input.camera->Rescaled(any.width, any.height);
  const double readout = *input.camera->readout_s / input.frame_interval_s;
  const double half = std::abs(readout) / 2.0;
  Spline spline(pairs->front().from_time_s - half, pairs->back().to_time_s + half);
  ceres::Problem problem;
  for (const PointTracks& tracks : *pairs) {
    AddTracks(tracks, camera, readout, spline, problem);
  }
  auto& keys = spline.keys();
  for (std::size_t i = 1; i + 1 < keys.size(); ++i) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SplineBendResidual, 3, 3, 3, 3>(
                                 new SplineBendResidual{kBendWeight}),
                             nullptr, keys[i - 1].data(), keys[i].data(), keys[i + 1].data());
  }
  // Only rotations between instants are seen: one key stands still.
  problem.SetParameterBlockConstant(keys[spline.At(0.0).key].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 30;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kUntrustworthy, "the tracks do not determine a motion");
  }
  std::vector<Eigen::Quaterniond> rotations;
  const int knots = ReadoutMotion::KnotCount(input.camera->height);
  for (int i = 0; i < knots; ++i) {
    const double row = (input.camera->height - 1.0) * i / (knots - 1);
    rotations.push_back(
        spline.Orientation(RowExposureTime(0.0, row, input.camera->height, readout)));
  }
  auto field = FieldFromRow(*input.camera, rotations, input.ReferenceRow());
  if (!field) {
    return Propagate(field.error());
  }
  return MethodAnswer{std::move(*field), {}};
}

}  // namespace rsstab::evaluation
