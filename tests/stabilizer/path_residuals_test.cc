// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/path_residuals.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "igf/base/homography.h"

namespace rsstab::stabilizer {
namespace {

constexpr UpdateParameters kTheta = {0.02, -0.03, 0.05, 0.01, -0.02, 0.03, 0.01, -0.015};

TEST(UpdateParameters, InverseUpdateInverts) {
  const Eigen::Vector2d q(0.31, -0.17);
  const Point2<double> p = ApplyUpdate<double>(kTheta.data(), 0.8, q);
  EXPECT_LT((ApplyInverseUpdate<double>(kTheta.data(), 0.8, p) - q).norm(), 1e-12);
}

TEST(UpdateParameters, TheMatrixMovesPointsAsTheFunctionDoes) {
  const Eigen::Matrix3d update = UpdateHomography(kTheta, 0.8);
  for (const Eigen::Vector2d& q : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.31, -0.17)}) {
    EXPECT_LT((ApplyUpdate<double>(kTheta.data(), 0.8, q) - Project(update, q)).norm(), 1e-12);
  }
}

// Automatic against numeric derivatives: a wrong branch or a template that drops a derivative
// shows.
template <typename Residual, int... kBlocks>
void CheckGradient(Residual* functor) {
  ceres::AutoDiffCostFunction<Residual, Residual::kSize, kBlocks...> cost(functor);
  std::vector<UpdateParameters> values(sizeof...(kBlocks));
  std::vector<double*> blocks;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = 0; k < kUpdateSize; ++k) {
      values[i][k] = 0.01 * std::sin(1.0 + 3.0 * static_cast<double>(i) + static_cast<double>(k));
    }
    blocks.push_back(values[i].data());
  }
  const std::vector<const ceres::Manifold*> none(blocks.size(), nullptr);
  ceres::NumericDiffOptions numeric;
  numeric.ridders_relative_initial_step_size = 1e-3;
  ceres::GradientChecker checker(&cost, &none, numeric);
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(blocks.data(), 1e-4, &results)) << results.error_log;
}

TEST(PathResiduals, DerivativesAreRight) {
  const PathPoints points = MakePathPoints(0.5625);
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  f.topRightCorner<2, 1>() = Eigen::Vector2d(0.01, -0.02);
  CheckGradient<DataResidual, 8>(new DataResidual{points, 0.8, 1.0, {1, 1, 1, 1, 1, 1, 1, 1}});
  CheckGradient<VelocityResidual, 8, 8>(new VelocityResidual{points, 0.8, 2.0, f});
  CheckGradient<AccelerationResidual, 8, 8, 8>(new AccelerationResidual{points, 0.8, 2.0, f, f});
  CheckGradient<JerkResidual, 8, 8, 8, 8>(new JerkResidual{points, 0.8, 2.0, f, f, f});
  CheckGradient<CropResidual, 8>(new CropResidual{0.8, 3.0, 1.3, 0.5625, true});
}

}  // namespace
}  // namespace rsstab::stabilizer
