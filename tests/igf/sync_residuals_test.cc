// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_residuals.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "igf/base/camera.h"

namespace rsstab::igf {
namespace {

// Relative; the numerical derivative of a double function is good to about 1e-9.
constexpr double kGradientTolerance = 1e-6;

// Two long spans of constant rate: smooth within each, and a match across the boundary sees both.
OrientationTrack TwoRates() {
  const Eigen::Quaterniond first = ExpSo3(Eigen::Vector3d(0.2, -0.5, 0.1));
  const Eigen::Quaterniond second = first * ExpSo3(Eigen::Vector3d(-0.3, 0.8, 0.4));
  return *OrientationTrack::Create({0.0, 1.0, 2.0},
                                   {Eigen::Quaterniond::Identity(), first, second});
}

bool GradientsMatch(const ceres::CostFunction& cost,
                    const std::vector<std::vector<double>>& parameters) {
  std::vector<const double*> blocks;
  for (const auto& block : parameters) {
    blocks.push_back(block.data());
  }
  ceres::NumericDiffOptions options;
  options.ridders_relative_initial_step_size = 1e-3;  // stays within the spans of the track
  const ceres::GradientChecker checker(
      &cost, static_cast<const std::vector<const ceres::Manifold*>*>(nullptr), options);
  ceres::GradientChecker::ProbeResults results;
  const bool matches = checker.Probe(blocks.data(), kGradientTolerance, &results);
  EXPECT_TRUE(matches) << results.error_log;
  return matches;
}

TEST(SyncResiduals, TrackGradientMatchesFiniteDifferences) {
  const OrientationTrack track = TwoRates();
  const ceres::AutoDiffCostFunction<SyncTrackResidual, 2, 1, 3, 1, 1, 1, 2> cost(
      new SyncTrackResidual(track, 1.97, 2.02,
                            SyncMatch{{0.3, -0.2}, {0.28, -0.17}, -0.3, 0.2, 0.1, 500.0}));
  for (const double curvature : {0.0, -0.3, 0.04}) {
    EXPECT_TRUE(GradientsMatch(
        cost, {{1.002}, {0.02, -0.01, 0.03}, {0.1}, {curvature}, {0.021}, {0.3, -0.2}}));
  }
}

TEST(SyncResiduals, PriorGradientMatchesFiniteDifferences) {
  const ceres::AutoDiffCostFunction<SyncPriorResidual<3>, 3, 3> cost(
      new SyncPriorResidual<3>(0.1, 0.05));
  EXPECT_TRUE(GradientsMatch(cost, {{0.3, -0.2, 0.1}}));
}

TEST(SyncResiduals, ZeroAtTheTruth) {
  const OrientationTrack track = TwoRates();
  const Eigen::Vector3d bias(0.03, 0.02, -0.01);
  const double offset_s = 0.4;
  const double readout_s = 0.02;
  const double focal = 1.25;
  const double curvature = -0.2;
  // The true camera turns at the track's rate less the bias; both instants lie in one span.
  const Eigen::Vector3d rate = track.AnchorAt(0.2).rate_rad_s - bias;
  const double from_s = 0.70 + readout_s * -0.25;
  const double to_s = 0.74 + readout_s * 0.35;
  const Eigen::Quaterniond to_from_from =
      ExpSo3(Eigen::Vector3d(rate * (to_s - from_s))).conjugate();
  const Eigen::Vector2d from_straight(0.25, -0.15);
  const Eigen::Vector2d to_straight =
      (to_from_from * Eigen::Vector3d(from_straight.x(), from_straight.y(), 1.0)).hnormalized();
  const SyncMatch match{focal * BendPlane(from_straight, curvature),
                        focal * BendPlane(to_straight, curvature),
                        -0.25,
                        0.35,
                        0.1,
                        500.0};
  const SyncTrackResidual residual(track, 0.70, 0.74, match);
  const double log_focal = std::log(focal);
  const std::array<double, 2> drift{};
  std::array<double, 2> r{};
  ASSERT_TRUE(
      residual(&offset_s, bias.data(), &log_focal, &curvature, &readout_s, drift.data(), r.data()));
  // The bias acts to first order over 40 ms.
  constexpr double kFirstOrder_px = 0.02;
  EXPECT_NEAR(r[0], 0.0, kFirstOrder_px);
  EXPECT_NEAR(r[1], 0.0, kFirstOrder_px);
  const double wrong_offset_s = -offset_s;
  ASSERT_TRUE(residual(&wrong_offset_s, bias.data(), &log_focal, &curvature, &readout_s,
                       drift.data(), r.data()));
  EXPECT_GT(std::hypot(r[0], r[1]), 1.0);
}

TEST(SyncResiduals, BendingAndStraighteningAreInverse) {
  for (const double curvature : {-0.4, 0.0, 0.05}) {
    const Eigen::Vector2d u(0.8, -0.6);
    EXPECT_LT((StraightenPlane(BendPlane(u, curvature), curvature) - u).norm(), 1e-12);
  }
  EXPECT_LT(BendPlane(Eigen::Vector2d(0.8, -0.6), -0.3).norm(), 1.0);  // a fisheye bends inwards
}

}  // namespace
}  // namespace rsstab::igf
