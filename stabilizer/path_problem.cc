// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>

#include <cmath>
#include <tuple>

#include "stabilizer/path_problem_detail.h"
#include "stabilizer/path_residuals.h"
#include "stabilizer/path_smoothness_detail.h"

namespace rsstab::stabilizer {
namespace {

// How unwillingly the update uses what a turn cannot tell, px per unit of theta (see
// update_parameters_detail.h): shift, zoom, stretch.
constexpr double kShiftReluctance = 1.5 * kReferenceWidthPx;
constexpr double kZoomReluctance = 1.0 * kReferenceWidthPx;
constexpr double kStretchReluctance = 10.0 * kReferenceWidthPx;
// The same when a sensor knows the turn: the tracks' noise must not leak into the picture's shape.
constexpr double kKnownRotationFactor = 100.0;
// With adaptive zoom the update's zoom hides the borders: corners that leave the picture cost
// kBorderWeight a pixel, zooming in kZoomCost a unit of log zoom (px), and how fast it may change
// follows from the smoothness of the output's motion, as for every other move.
constexpr double kBorderWeight = 60.0;
constexpr double kZoomCost = 2.0 * kReferenceWidthPx;
constexpr double kTripodWeight = 300.0;
constexpr double kTripodDataWeight = 0.05;

constexpr int kMaxIterations = 12;
constexpr int kMaxLiveIterations = 5;  // windows begin where the one before ended

// A term in the updates of as many frames as there are thetas.
template <typename Residual, typename... Theta>
void AddTerm(ceres::Problem& problem, const Residual& residual, Theta&... thetas) {
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<Residual, Residual::kSize,
                                      static_cast<int>(std::tuple_size_v<Theta>)...>(
          new Residual(residual)),
      nullptr, thetas.data()...);
}

DataResidual MakeDataResidual(const PathSmootherOptions& options) {
  const double known = options.rotation_known ? kKnownRotationFactor : 1.0;
  const double shift = known * kShiftReluctance;
  const double zoom = options.adaptive_zoom ? kZoomCost : known * kZoomReluctance;
  const double stretch = known * kStretchReluctance;
  return {MakePathPoints(options.aspect),
          options.focal_ratio,
          options.tripod ? kTripodDataWeight : kDataWeight,
          {0.0, 0.0, 0.0, shift, shift, zoom, stretch, stretch}};
}

// What concerns the update of one frame alone.
void AddFrameTerms(const PathSmootherOptions& options, double crop_weight, ceres::Problem& problem,
                   UpdateParameters& theta) {
  const double f = options.focal_ratio;
  AddTerm(problem, MakeDataResidual(options), theta);
  AddTerm(problem, CropResidual{f, crop_weight, options.min_crop_ratio, options.aspect, false},
          theta);
  if (options.adaptive_zoom) {
    AddTerm(problem, CropResidual{f, kBorderWeight, 1.0, options.aspect, true}, theta);
  }
}

// How the output moves from the frames before to frame `i`.
void AddTemporalTerms(const PathSmootherOptions& options, std::size_t i, ceres::Problem& problem,
                      PathWindow& window) {
  const PathPoints points = MakePathPoints(options.aspect);
  const double f = options.focal_ratio;
  const TemporalWeights weights = MakeTemporalWeights(options);
  const auto theta = [&](std::size_t back) -> UpdateParameters& { return window[i - back].theta; };
  const auto motion = [&](std::size_t back) { return window[i - back].motion.to_from; };
  if (options.tripod && i >= 1) {
    AddTerm(problem,
            VelocityResidual{points, f, kTripodWeight * std::sqrt(window[i].relaxation), motion(0)},
            theta(1), theta(0));
  }
  if (i >= 2) {
    AddTerm(problem,
            AccelerationResidual{points, f, window.TemporalWeight(weights.acceleration, i, 2),
                                 motion(1), motion(0)},
            theta(2), theta(1), theta(0));
  }
  if (i >= 3) {
    AddTerm(problem,
            JerkResidual{points, f, window.TemporalWeight(weights.jerk, i, 3), motion(2), motion(1),
                         motion(0)},
            theta(3), theta(2), theta(1), theta(0));
  }
}

}  // namespace

Status SolvePath(const PathSmootherOptions& options, double crop_weight, PathWindow& window) {
  ceres::Problem problem;
  for (std::size_t i = 0; i < window.size(); ++i) {
    UpdateParameters& theta = window[i].theta;
    problem.AddParameterBlock(theta.data(), kUpdateSize);
    if (i < window.first_open()) {
      problem.SetParameterBlockConstant(theta.data());
      continue;
    }
    AddFrameTerms(options, crop_weight, problem, theta);
    AddTemporalTerms(options, i, problem, window);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.lookahead_frames ? kMaxLiveIterations : kMaxIterations;
  solver.function_tolerance = 1e-4;
  solver.initial_trust_region_radius = 1e8;  // nearly linear: begin with a full step
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kInternal, "smoothing the camera path failed: {}", summary.message);
  }
  return {};
}

}  // namespace rsstab::stabilizer
