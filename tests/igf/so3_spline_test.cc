// SPDX-License-Identifier: Apache-2.0
#include "igf/so3_spline.h"

#include <gtest/gtest.h>

#include <random>

namespace rsstab::igf {
namespace {

constexpr double kRoundOff = 1e-12;
constexpr double kInterval = 0.01;

Eigen::Vector3d RandomVector(std::mt19937& rng, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  return {uniform(rng), uniform(rng), uniform(rng)};
}

struct FourKnots {
  std::array<Eigen::Quaterniond, kSplineOrder> knots;
  [[nodiscard]] SplinePoint At(double u) const {
    std::array<SplineStep, 3> steps;
    for (std::size_t j = 0; j < 3; ++j) {
      steps[j] = MakeSplineStep(knots[j], knots[j + 1]);
    }
    return EvaluateSplineWithJacobians(knots[0], steps.data(), u, kInterval);
  }
};

FourKnots RandomKnots(std::mt19937& rng) {
  FourKnots four;
  Eigen::Quaterniond q = ExpSo3(RandomVector(rng, 1.0));
  for (Eigen::Quaterniond& knot : four.knots) {
    knot = q;
    q = q * ExpSo3(RandomVector(rng, 0.4));
  }
  return four;
}

TEST(So3Jacobians, RightJacobianIsTheSlopeOfTheExponential) {
  std::mt19937 rng(1);
  // A central difference of step h is off by about h^2 and by round-off over h.
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-8;
  for (const double size : {0.0, 1e-5, 0.3, 1.5}) {
    const Eigen::Vector3d v = RandomVector(rng, size);
    const Eigen::Matrix3d jacobian = RightJacobianSo3(v);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d e = kStep * Eigen::Vector3d::Unit(axis);
      const Eigen::Quaterniond turned =
          ExpSo3(Eigen::Vector3d(v - e)).conjugate() * ExpSo3(Eigen::Vector3d(v + e));
      EXPECT_TRUE(jacobian.col(axis).isApprox(LogSo3(turned) / (2.0 * kStep), kTolerance));
    }
    EXPECT_TRUE((jacobian * InverseRightJacobianSo3(v)).isIdentity(1e-11));
  }
}

TEST(So3Spline, JacobiansAndRateAreTheSlopesOfTheCurve) {
  std::mt19937 rng(2);
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-7;
  for (const double u : {0.0, 0.25, 0.6, 0.999}) {
    const FourKnots four = RandomKnots(rng);
    const SplinePoint point = four.At(u);
    for (std::size_t k = 0; k < kSplineOrder; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d e = kStep * Eigen::Vector3d::Unit(axis);
        FourKnots more = four;
        more.knots[k] = more.knots[k] * ExpSo3(e);
        FourKnots less = four;
        less.knots[k] = less.knots[k] * ExpSo3(Eigen::Vector3d(-e));
        const Eigen::Vector3d slope =
            LogSo3(Eigen::Quaterniond(less.At(u).world_from_camera.conjugate() *
                                      more.At(u).world_from_camera)) /
            (2.0 * kStep);
        EXPECT_LT((point.by_knot[k].col(axis) - slope).norm(), kTolerance) << k << " " << axis;
      }
    }
    const Eigen::Vector3d rate =
        LogSo3(Eigen::Quaterniond(four.At(u - kStep).world_from_camera.conjugate() *
                                  four.At(u + kStep).world_from_camera)) /
        (2.0 * kStep * kInterval);
    EXPECT_LT((point.rate_rad_s - rate).norm(), 1e-4 * rate.norm());
  }
}

TEST(So3Spline, SteadyTurnIsReproduced) {
  const Eigen::Vector3d rate(0.3, -2.0, 0.7);
  So3Spline spline(5.0, kInterval);
  for (int k = 0; k < 8; ++k) {
    spline.Append(ExpSo3(Eigen::Vector3d(rate * (k * kInterval))));
  }
  EXPECT_DOUBLE_EQ(spline.begin_s(), 5.01);
  EXPECT_DOUBLE_EQ(spline.end_s(), 5.06);
  for (double t = 5.01; t < 5.06; t += 0.0037) {
    const auto r = spline.CameraFromWorld(t);
    ASSERT_TRUE(r.has_value());
    EXPECT_LT(r->angularDistance(ExpSo3(Eigen::Vector3d(rate * (t - 5.0))).conjugate()), 1e-9);
  }
  EXPECT_FALSE(spline.CameraFromWorld(5.0099).has_value());
  EXPECT_FALSE(spline.CameraFromWorld(5.06).has_value());
}

TEST(So3Spline, CurveIsTheSameFromEitherEvaluation) {
  std::mt19937 rng(3);
  const FourKnots four = RandomKnots(rng);
  So3Spline spline(0.0, kInterval);
  for (const Eigen::Quaterniond& knot : four.knots) {
    spline.Append(knot);
  }
  const auto r = spline.CameraFromWorld(1.4 * kInterval);
  ASSERT_TRUE(r.has_value());
  EXPECT_LT(r->angularDistance(four.At(0.4).world_from_camera.conjugate()), 1e-7);
}

}  // namespace
}  // namespace rsstab::igf
