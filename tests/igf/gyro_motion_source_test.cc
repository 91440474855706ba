// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_motion_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

OrientationTrack YawRight() {
  return *OrientationTrack::Create(
      {0.0, 1.0}, {Eigen::Quaterniond::Identity(), ExpSo3(Eigen::Vector3d(0.0, 1.0, 0.0))});
}

// Through the interface, as the pipeline uses it.
TEST(GyroMotionSource, AnswersFromTheTrackAlone) {
  const Camera camera = Camera::Pinhole(640, 360, 500.0);
  GyroMotionSource gyro = *GyroMotionSource::Create(camera, 0.020, YawRight());
  RsMotionSource& source = gyro;
  EXPECT_EQ(source.Name(), "gyro");
  EXPECT_FALSE(source.NeedsImage());
  const auto motion = source.EstimateMotion({.index = 15, .time_s = 0.5, .image = nullptr});
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->spread_px, 0.0);
  EXPECT_NEAR(motion->field.Sample({319.5, 0.0}).x(), 500.0 * 0.010, 0.05);
  EXPECT_NEAR(LogSo3(*source.CameraFromWorld(0.5)).y(), -0.5, 1e-9);
  EXPECT_FALSE(source.CameraFromWorld(1.0));
}

TEST(GyroMotionSource, TellsATurnButNotOverAGap) {
  const auto track = OrientationTrack::Create(
      {0.0, 1.0, 2.0, 3.0},
      {Eigen::Quaterniond::Identity(), ExpSo3(Eigen::Vector3d(0.0, 0.5, 0.0)),
       ExpSo3(Eigen::Vector3d(0.0, 1.0, 0.0)), ExpSo3(Eigen::Vector3d(0.0, 1.5, 0.0))},
      {{1.0, 2.0}});
  ASSERT_TRUE(track);
  const auto source = GyroMotionSource::Create(Camera::Pinhole(640, 360, 500.0), 0.020, *track);
  ASSERT_TRUE(source);
  // To the right: what lies ahead then lies to the left of the camera.
  const auto turn = source->TurnBetween(0.2, 0.8);
  ASSERT_TRUE(turn);
  EXPECT_NEAR(LogSo3(*turn).y(), -0.3, 1e-9);
  EXPECT_TRUE(source->TurnBetween(2.1, 2.9));
  EXPECT_FALSE(source->TurnBetween(0.8, 2.2));
  EXPECT_FALSE(source->TurnBetween(2.8, 3.2));
}

TEST(GyroMotionSource, NamesTheFrameItCannotTell) {
  GyroMotionSource source =
      *GyroMotionSource::Create(Camera::Pinhole(640, 360, 500.0), 0.020, YawRight());
  const auto motion = source.EstimateMotion({.index = 42, .time_s = 1.4, .image = nullptr});
  ASSERT_FALSE(motion);
  EXPECT_EQ(motion.error().code, ErrorCode::kUntrustworthy);
  EXPECT_THAT(motion.error().message, ::testing::HasSubstr("frame 42"));
}

TEST(GyroMotionSource, RefusesWhatMakesNoSense) {
  EXPECT_FALSE(GyroMotionSource::Create(Camera::Pinhole(0, 360, 500.0), 0.020, YawRight()));
  EXPECT_FALSE(GyroMotionSource::Create(Camera::Pinhole(640, 360, 500.0), 20.0, YawRight()));
  EXPECT_FALSE(
      GyroMotionSource::Create(Camera::Pinhole(640, 360, 500.0), 0.020, YawRight(), {17, 1}));
}

}  // namespace
}  // namespace rsstab::igf
