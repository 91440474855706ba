// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/robust_homography.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "igf/base/homography.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kScalePx = 2.5;

Eigen::Matrix3d SomeHomography() {
  Eigen::Matrix3d h;
  h << 1.02, -0.03, 12.0, 0.025, 0.99, -7.0, 2e-5, -1e-5, 1.0;
  return h;
}

// 200 matches of SomeHomography; every `outlier_every`-th one is wrong by up to 60 px.
std::vector<PointMatch> Matches(double noise, int outlier_every) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(0.0, 640.0);
  std::uniform_real_distribution<double> y(0.0, 360.0);
  std::uniform_real_distribution<double> wrong(-60.0, 60.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<PointMatch> matches;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d from(x(random), y(random));
    Eigen::Vector2d to = Project(SomeHomography(), from);
    to += noise * Eigen::Vector2d(normal(random), normal(random));
    if (outlier_every > 0 && i % outlier_every == 0) {
      to += Eigen::Vector2d(wrong(random), wrong(random));
    }
    matches.push_back({from.cast<float>(), to.cast<float>()});
  }
  return matches;
}

double CornerError(const Eigen::Matrix3d& h) {
  double worst = 0.0;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 0), Eigen::Vector2d(639, 0),
                                        Eigen::Vector2d(0, 359), Eigen::Vector2d(639, 359)}) {
    worst = std::max(worst, (Project(h, corner) - Project(SomeHomography(), corner)).norm());
  }
  return worst;
}

TEST(RobustHomography, IsExactOnExactMatches) {
  const auto h = RobustHomography(Matches(0.0, 0), kScalePx);
  ASSERT_TRUE(h);
  EXPECT_LT(CornerError(*h), 1e-3);  // float matches
  const auto plain = LeastSquaresHomography(Matches(0.0, 0), Eigen::Matrix3d::Identity());
  ASSERT_TRUE(plain);
  EXPECT_LT(CornerError(*plain), 1e-3);
}

TEST(RobustHomography, StandsAThirdOfWrongMatches) {
  const auto h = RobustHomography(Matches(0.1, 3), kScalePx);
  ASSERT_TRUE(h);
  // 0.1 px of noise on 130 good matches leaves about 0.04 px in the corners; wrong ones pull a bit.
  EXPECT_LT(CornerError(*h), 0.3);
}

TEST(RobustHomography, RefusesMatchesThatShareNothing) {
  std::vector<PointMatch> matches = Matches(0.0, 1);
  EXPECT_FALSE(RobustHomography(matches, kScalePx));
  matches.resize(kFewestMatches - 1);
  EXPECT_FALSE(RobustHomography(matches, kScalePx));
  EXPECT_FALSE(LeastSquaresHomography(matches, Eigen::Matrix3d::Identity()));
}

TEST(RobustHomography, RefusesInSilenceAStartThatTurnsPointsBack) {
  Eigen::Matrix3d start = SomeHomography();
  start(2, 0) = -1.0 / 300.0;  // beyond x = 300 the denominator is negative
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(LeastSquaresHomography(Matches(0.0, 0), start));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(RobustHomography, RefusesPointsOnOneSpot) {
  const std::vector<PointMatch> matches(30, PointMatch{{5.0F, 5.0F}, {6.0F, 6.0F}});
  EXPECT_FALSE(RobustHomography(matches, kScalePx));
}

}  // namespace
}  // namespace rsstab::stabilizer
