// SPDX-License-Identifier: Apache-2.0
#include "igf/imu_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <string>

namespace rsstab::igf {
namespace {

using ::testing::HasSubstr;

const Eigen::Vector3d kReading(1.0, 2.0, 3.0);

Eigen::Vector3d Apply(const Result<Eigen::Matrix3d>& map) {
  EXPECT_TRUE(map.has_value()) << (map ? "" : map.error().message);
  return map ? Eigen::Vector3d(*map * kReading) : Eigen::Vector3d::Zero();
}

TEST(ImuAxes, LetterNamesTheInputThatSuppliesTheOutput) {
  EXPECT_EQ(Apply(ParseAxisString("XYZ")), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(Apply(ParseAxisString("YxZ")), Eigen::Vector3d(2, -1, 3));
  EXPECT_EQ(Apply(ParseAxisString("yXz")), Eigen::Vector3d(-2, 1, -3));
  EXPECT_EQ(Apply(ParseAxisString("zxY")), Eigen::Vector3d(-3, -1, 2));
}

TEST(ImuAxes, RefusesWhatIsNoAxisString) {
  for (const std::string bad : {"", "XY", "XYZW", "XYY", "xXy", "ABC", "X Z", "12"}) {
    const auto map = ParseAxisString(bad);
    ASSERT_FALSE(map.has_value()) << bad;
    EXPECT_EQ(map.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(map.error().message, HasSubstr("\"" + bad + "\""));
  }
  const auto map = ParseAxisString(std::string(1000, '\1'));
  ASSERT_FALSE(map.has_value());
  EXPECT_LT(map.error().message.size(), 200U);
}

TEST(ImuAxes, BodyAxesOfBothVendorsAreRightHanded) {
  EXPECT_DOUBLE_EQ(CameraFromGyroflowAxes().determinant(), 1.0);
  EXPECT_DOUBLE_EQ(CameraFromGoProAxes().determinant(), 1.0);
}

// A camera that yaws to the right turns about its down axis, positively. Gyroflow's x points up, so
// its reading is negative; so is the first channel that a GoPro with order Z, X, Y stores.
TEST(ImuAxes, AYawToTheRightIsPositiveAboutTheDownAxis) {
  const Eigen::Vector3d stored(-0.5, 0.0, 0.0);
  EXPECT_EQ(*CameraFromGyroflowOrientation("XYZ") * stored, Eigen::Vector3d(0, 0.5, 0));
  EXPECT_EQ(*CameraFromGoProChannels("ZXY") * stored, Eigen::Vector3d(0, 0.5, 0));
}

// Stored (Z, X, Y) = (a, b, c): omega = (-b, -a, -c), as measured against image motion.
TEST(ImuAxes, GoProDocumentedOrder) {
  EXPECT_EQ(Apply(CameraFromGoProChannels("ZXY")), Eigen::Vector3d(-2, -1, -3));
}

// ORIN YxZ, ORIO ZXY means (c0, c1, c2) -> (c2, -c1, c0) = (Z, X, Y), which MTRX says as well.
TEST(ImuAxes, OrinAndMatrixAgree) {
  Eigen::Matrix3d mtrx;
  mtrx << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  EXPECT_EQ(mtrx * kReading, Eigen::Vector3d(3, -2, 1));
  EXPECT_EQ(Apply(CameraFromGoProChannels("YxZ")), Eigen::Vector3d(2, -3, -1));
  EXPECT_EQ(Apply(CameraFromGoProMatrix(mtrx, "ZXY")), Eigen::Vector3d(2, -3, -1));
  // Gyroflow reads the same matrix as the orientation ZyX.
  EXPECT_EQ(Apply(CameraFromGyroflowOrientation("ZyX")), Eigen::Vector3d(2, -3, -1));
}

TEST(ImuAxes, RefusesAMatrixThatIsNoRotation) {
  Eigen::Matrix3d mtrx = Eigen::Matrix3d::Identity();
  EXPECT_FALSE(CameraFromGoProMatrix(mtrx, "ZZY").has_value());
  mtrx(1, 1) = 0.0;
  EXPECT_FALSE(CameraFromGoProMatrix(mtrx, "ZXY").has_value());
  mtrx(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(CameraFromGoProMatrix(mtrx, "ZXY").has_value());
}

}  // namespace
}  // namespace rsstab::igf
