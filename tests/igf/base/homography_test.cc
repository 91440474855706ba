// SPDX-License-Identifier: Apache-2.0
#include "igf/base/homography.h"

#include <gtest/gtest.h>

namespace rsstab {
namespace {

Eigen::Matrix3d SomeHomography() {
  Eigen::Matrix3d h;
  h << 1.02, 0.03, 4.0, -0.02, 0.98, -7.0, 1e-5, -2e-5, 1.0;
  return h;
}

TEST(Homography, FourPointsDetermineIt) {
  const std::array<Eigen::Vector2d, 4> source = {
      {{0.0, 0.0}, {639.0, 0.0}, {639.0, 359.0}, {0.0, 359.0}}};
  std::array<Eigen::Vector2d, 4> target;
  for (std::size_t i = 0; i < 4; ++i) {
    target[i] = Project(SomeHomography(), source[i]);
  }
  const auto h = HomographyFromFourPoints(source, target);
  ASSERT_TRUE(h);
  EXPECT_LT((*h - SomeHomography()).norm(), 1e-8);
}

TEST(Homography, CollinearPointsGiveNone) {
  const std::array<Eigen::Vector2d, 4> line = {{{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}, {5.0, 1.0}}};
  EXPECT_FALSE(HomographyFromFourPoints(line, line));
}

TEST(Homography, InverseRefusesSingularFlippedAndNan) {
  EXPECT_TRUE(InvertChecked(SomeHomography()));
  EXPECT_FALSE(InvertChecked(Eigen::Matrix3d::Zero()));
  const Eigen::Matrix3d flip = Eigen::Vector3d(-1.0, 1.0, 1.0).asDiagonal();
  EXPECT_FALSE(InvertChecked(flip));
  EXPECT_FALSE(InvertChecked(Eigen::Matrix3d::Constant(std::nan(""))));
}

TEST(Homography, ProjectCheckedRefusesPointsBehind) {
  Eigen::Matrix3d h = Eigen::Matrix3d::Identity();
  h(2, 0) = -0.01;
  EXPECT_TRUE(ProjectChecked(h, {50.0, 0.0}));
  EXPECT_FALSE(ProjectChecked(h, {150.0, 0.0}));
}

TEST(Homography, RescaleKeepsPixelCentres) {
  // The corner of the image area lies half a pixel outside the first centre, at every size.
  const Eigen::Matrix3d big = RescaleHomography(SomeHomography(), 640, 360, 1920, 1080);
  const Eigen::Vector2d small_point(100.0, 50.0);
  const Eigen::Vector2d big_point = ((small_point.array() + 0.5) * 3.0 - 0.5).matrix();
  const Eigen::Vector2d expected =
      ((Project(SomeHomography(), small_point).array() + 0.5) * 3.0 - 0.5).matrix();
  EXPECT_LT((Project(big, big_point) - expected).norm(), 1e-9);
}

TEST(Homography, AnisotropyIsOneForSimilarities) {
  Eigen::Matrix3d similarity = Eigen::Matrix3d::Identity();
  similarity.topLeftCorner<2, 2>() << 0.8, -0.6, 0.6, 0.8;
  EXPECT_NEAR(AffineAnisotropy(2.0 * similarity), 1.0, 1e-12);
  Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
  stretch(0, 0) = 0.9;
  EXPECT_NEAR(AffineAnisotropy(stretch), 0.9, 1e-12);
}

}  // namespace
}  // namespace rsstab
