// SPDX-License-Identifier: Apache-2.0
#include "igf/base/rotation.h"

#include <gtest/gtest.h>

#include "igf/base/camera.h"
#include "igf/base/homography.h"

namespace rsstab {
namespace {

constexpr double kRoundOff = 1e-12;

TEST(Rotation, LogInvertsExpOnBothSidesOfTheSeriesSwitch) {
  for (const double angle : {0.0, 1e-9, 0.99e-4, 1.01e-4, 0.5, 3.1}) {
    const Eigen::Vector3d w = angle * Eigen::Vector3d(1.0, -2.0, 2.0) / 3.0;
    EXPECT_LT((LogSo3(ExpSo3(w)) - w).norm(), kRoundOff) << angle;
    EXPECT_NEAR(ExpSo3(w).norm(), 1.0, kRoundOff) << angle;
  }
}

TEST(Rotation, LogIgnoresTheSignOfTheQuaternion) {
  const Eigen::Quaterniond q = ExpSo3(Eigen::Vector3d(0.3, -0.2, 0.1));
  const Eigen::Quaterniond negative(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_LT((LogSo3(q) - LogSo3(negative)).norm(), kRoundOff);
}

// Camera axes are x right, y down, z forward: a positive turn about y looks to the right, so the
// picture moves left. Fails if R(t) is taken as world_from_camera.
TEST(Rotation, YawToTheRightMovesThePictureLeft) {
  const Camera camera = Camera::Pinhole(640, 360, 500.0);
  const Eigen::Quaterniond world_from_camera_later = ExpSo3(Eigen::Vector3d(0.0, 0.01, 0.0));
  const Eigen::Matrix3d later_from_earlier = RotationHomography(
      camera.K(), world_from_camera_later.conjugate(), Eigen::Quaterniond::Identity());
  const Eigen::Vector2d centre(camera.cx, camera.cy);
  const Eigen::Vector2d moved = Project(later_from_earlier, centre);
  EXPECT_NEAR(moved.x() - centre.x(), -500.0 * std::tan(0.01), 1e-9);
  EXPECT_NEAR(moved.y(), centre.y(), 1e-9);
}

}  // namespace
}  // namespace rsstab
