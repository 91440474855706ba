// SPDX-License-Identifier: Apache-2.0
#include "igf/base/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

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
