// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "stabilizer/local_path_problem_detail.h"
#include "stabilizer/path_smoothness_detail.h"

namespace rsstab::stabilizer {
namespace {

// Pull to the camera's own local path, and the neighbour term.
constexpr double kLocalDataWeight = 2.0;
constexpr double kNeighbourWeight = 4.0;

// |P - C|^2 (1 + neighbour term of the mode) for one spatial mode.
class LocalDataCost final : public ceres::SizedCostFunction<2, 2> {
 public:
  LocalDataCost(double weight, Eigen::Vector2d path) : weight_(weight), path_(std::move(path)) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    for (int i = 0; i < 2; ++i) {
      residuals[i] = weight_ * (parameters[0][i] - path_(i));
    }
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> j(jacobians[0]);
      j = weight_ * Eigen::Matrix2d::Identity();
    }
    return true;
  }

 private:
  double weight_;
  Eigen::Vector2d path_;
};

// Second and third differences of P for one spatial mode.
class LocalTemporalCost final : public ceres::SizedCostFunction<4, 2, 2, 2, 2> {
 public:
  LocalTemporalCost(double acceleration, double jerk)
      : coefficients_{{{0.0, -jerk},
                       {acceleration, 3.0 * jerk},
                       {-2.0 * acceleration, -3.0 * jerk},
                       {acceleration, jerk}}} {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::Vector4d> r(residuals);
    r.setZero();
    for (std::size_t k = 0; k < coefficients_.size(); ++k) {
      const Eigen::Map<const Eigen::Vector2d> p(parameters[k]);
      r.head<2>() += coefficients_[k][0] * p;
      r.tail<2>() += coefficients_[k][1] * p;
      if (jacobians != nullptr && jacobians[k] != nullptr) {
        Eigen::Map<Eigen::Matrix<double, 4, 2, Eigen::RowMajor>> j(jacobians[k]);
        j.topRows<2>() = coefficients_[k][0] * Eigen::Matrix2d::Identity();
        j.bottomRows<2>() = coefficients_[k][1] * Eigen::Matrix2d::Identity();
      }
    }
    return true;
  }

 private:
  std::array<std::array<double, 2>, 4> coefficients_;
};

// Largest way that any local path, the camera's or the smooth one, has from where the window
// begins.
double LargestMotion(const SpatialModes& modes, const PathWindow& window) {
  double motion = 0.0;
  for (std::size_t i = 0; i < window.size(); ++i) {
    for (std::size_t k = 0; k < modes.count(); ++k) {
      const Eigen::Vector2d& rest = window[0].local_path[k];
      motion = std::max({motion, (window[i].local_path[k] - rest).norm(),
                         (window[i].local_smooth[k] - rest).norm()});
    }
  }
  return motion;
}

void AddMode(const TemporalWeights& weights, const SpatialModes& modes, std::size_t mode,
             ceres::Problem& problem, PathWindow& window) {
  const double data_weight =
      kLocalDataWeight * std::sqrt(1.0 + kNeighbourWeight * modes.stiffness(mode));
  const auto smooth = [&](std::size_t i) { return window[i].local_smooth[mode].data(); };
  for (std::size_t i = 0; i < window.size(); ++i) {
    problem.AddParameterBlock(smooth(i), 2);
    if (i < window.first_open()) {
      problem.SetParameterBlockConstant(smooth(i));
      continue;
    }
    problem.AddResidualBlock(new LocalDataCost(data_weight, window[i].local_path[mode]), nullptr,
                             smooth(i));
    if (i >= 3) {
      problem.AddResidualBlock(
          new LocalTemporalCost(window.TemporalWeight(weights.acceleration, i, 2),
                                window.TemporalWeight(weights.jerk, i, 3)),
          nullptr, smooth(i - 3), smooth(i - 2), smooth(i - 1), smooth(i));
    }
  }
}

}  // namespace

Status SolveLocalPaths(const PathSmootherOptions& options, const SpatialModes& modes,
                       PathWindow& window) {
  // Without local motion in the window (a gyro clip without parallax, no texture) nothing to do,
  // once the smooth path has come to rest, too.
  if (LargestMotion(modes, window) == 0.0) {
    return {};
  }
  ceres::Problem problem;
  const TemporalWeights weights = MakeTemporalWeights(options);
  for (std::size_t k = 0; k < modes.count(); ++k) {
    AddMode(weights, modes, k, problem, window);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = 3;  // linear: one step, one to see that it was right
  solver.initial_trust_region_radius = 1e12;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kInternal, "smoothing the local camera paths failed: {}",
                summary.message);
  }
  return {};
}

}  // namespace rsstab::stabilizer
