// SPDX-License-Identifier: Apache-2.0
#include "igf/base/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace rsstab {
namespace {

Camera Fisheye() {
  Camera camera = Camera::Pinhole(1000, 750, 600.0);
  camera.model = LensModel::kFisheye;
  camera.distortion = {0.067292, -0.052752, 0.121414, -0.077412};
  return camera;
}

Camera Brown() {
  Camera camera = Camera::Pinhole(1000, 750, 800.0);
  camera.model = LensModel::kBrown;
  camera.distortion = {-0.2, 0.05, 0.001, -0.002, -0.005};
  return camera;
}

TEST(Camera, ProjectInvertsUnprojectForEveryLens) {
  for (const Camera& camera : {Camera::Pinhole(1000, 750, 600.0), Fisheye(), Brown()}) {
    ASSERT_TRUE(camera.Validate());
    for (double y = 0.0; y < 750.0; y += 107.0) {
      for (double x = 0.0; x < 1000.0; x += 111.0) {
        const auto ray = camera.UnprojectPixel({x, y});
        ASSERT_TRUE(ray) << x << "," << y;
        const auto back = camera.ProjectRay(*ray);
        ASSERT_TRUE(back);
        EXPECT_LT((*back - Eigen::Vector2d(x, y)).norm(), 1e-6) << x << "," << y;
      }
    }
  }
}

TEST(Camera, FisheyeBendsTowardsTheCentre) {
  // 40 degrees off axis lands nearer to the centre than through a pinhole of the same focal length.
  const Camera lens = Fisheye();
  const Camera pinhole = Camera::Pinhole(1000, 750, 600.0);
  const Eigen::Vector3d ray(std::tan(0.7), 0.0, 1.0);
  EXPECT_LT(lens.ProjectRay(ray)->x(), pinhole.ProjectRay(ray)->x());
}

// GoPro HERO7 4:3 "wide", calibrated at 4000x3000: the polynomial folds at 70 degrees, the corners
// lie beyond it.
Camera FoldingFisheye() {
  Camera camera = Camera::Pinhole(1000, 750, 438.0);
  camera.model = LensModel::kFisheye;
  camera.distortion = {0.067292, -0.052752, 0.121414, -0.077412};
  return camera;
}

TEST(Camera, FisheyeContinuesStraightWhereItsPolynomialFolds) {
  const Camera camera = FoldingFisheye();
  double last_theta = -1.0;
  // From the centre to a little beyond the corner (90 degrees off the axis are 6% beyond).
  for (double share = 0.0; share <= 1.05; share += 0.01) {
    const Eigen::Vector2d pixel(camera.cx * (1.0 + share), camera.cy * (1.0 + share));
    const auto ray = camera.UnprojectPixel(pixel);
    ASSERT_TRUE(ray) << share;
    const double theta = std::atan(ray->head<2>().norm());
    EXPECT_GT(theta, last_theta) << share;
    last_theta = theta;
    const auto back = camera.ProjectRay(*ray);
    ASSERT_TRUE(back) << share;
    EXPECT_LT((*back - pixel).norm(), 1e-6) << share;
  }
}

TEST(Camera, FisheyeGivesEveryRayItsOwnPixel) {
  const Camera camera = FoldingFisheye();
  double last = -1.0;
  for (double theta = 0.0; theta < 3.0; theta += 0.01) {
    const auto pixel = camera.ProjectRay({std::sin(theta), 0.0, std::cos(theta)});
    ASSERT_TRUE(pixel) << theta;
    EXPECT_GT(pixel->x() - camera.cx, last) << theta;
    last = pixel->x() - camera.cx;
  }
}

// Inside the calibrated part nothing may change: 45 degrees off axis by the published formula.
TEST(Camera, FisheyeKeepsItsPolynomialBeforeTheFold) {
  const Camera camera = FoldingFisheye();
  const double theta = std::numbers::pi / 4.0;
  const double t2 = theta * theta;
  const double theta_d = theta * (1.0 + 0.067292 * t2 - 0.052752 * t2 * t2 +
                                  0.121414 * t2 * t2 * t2 - 0.077412 * t2 * t2 * t2 * t2);
  EXPECT_NEAR(camera.ProjectRay({1.0, 0.0, 1.0})->x(), camera.cx + 438.0 * theta_d, 1e-9);
}

TEST(Camera, NothingBehindAPinhole) {
  EXPECT_FALSE(Camera::Pinhole(64, 48, 50.0).ProjectRay({0.1, 0.1, -1.0}));
}

TEST(Camera, RescaleKeepsTheView) {
  const Camera big = Brown();
  const Camera small = big.Rescaled(500, 375);
  const Eigen::Vector3d ray(0.2, -0.1, 1.0);
  const Eigen::Vector2d p = *big.ProjectRay(ray);
  const Eigen::Vector2d q = *small.ProjectRay(ray);
  EXPECT_NEAR(q.x() + 0.5, (p.x() + 0.5) / 2.0, 1e-9);
  EXPECT_NEAR(q.y() + 0.5, (p.y() + 0.5) / 2.0, 1e-9);
}

TEST(Camera, ValidateNamesTheBrokenRule) {
  Camera camera = Camera::Pinhole(64, 48, -1.0);
  EXPECT_THAT(camera.Validate().error().message, ::testing::HasSubstr("focal length"));
  camera = Fisheye();
  camera.distortion.pop_back();
  EXPECT_FALSE(camera.Validate());
  camera = Brown();
  camera.distortion[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera.Validate());
}

}  // namespace
}  // namespace rsstab
