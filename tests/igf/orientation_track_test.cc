// SPDX-License-Identifier: Apache-2.0
#include "igf/orientation_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

constexpr double kRoundOff = 1e-12;

// Turning at a constant rate: SLERP is then exact at every instant.
OrientationTrack ConstantRate(const Eigen::Vector3d& rate, const std::vector<double>& times) {
  std::vector<Eigen::Quaterniond> world_from_camera;
  for (const double t : times) {
    world_from_camera.push_back(ExpSo3(Eigen::Vector3d(rate * t)));
  }
  return *OrientationTrack::Create(times, std::move(world_from_camera));
}

TEST(OrientationTrack, HandsOutCameraFromWorld) {
  const Eigen::Vector3d rate(0.0, 0.5, 0.0);  // yaw to the right
  const OrientationTrack track = ConstantRate(rate, {0.0, 1.0});
  const Eigen::Quaterniond r = *track.CameraFromWorld(0.4);
  // A direction straight ahead at t = 0 is to the left (negative x) once the camera turned right.
  const Eigen::Vector3d seen = r * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(seen.x(), -std::sin(0.2), kRoundOff);
  EXPECT_NEAR(seen.z(), std::cos(0.2), kRoundOff);
}

TEST(OrientationTrack, InterpolatesIrregularSamples) {
  const Eigen::Vector3d rate(0.3, -0.7, 0.2);
  // Far from uniform, so that the index guess is wrong by more than the walk covers.
  const OrientationTrack track =
      ConstantRate(rate, {0.0, 0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.007, 0.5, 1.0, 1.9});
  for (double t = 0.0; t < 1.9; t += 0.0013) {
    const auto r = track.CameraFromWorld(t);
    ASSERT_TRUE(r) << t;
    EXPECT_LT(r->angularDistance(ExpSo3(Eigen::Vector3d(-rate * t))), 1e-7) << t;
  }
}

TEST(OrientationTrack, TakesTheShortWayBetweenOppositeQuaternions) {
  const Eigen::Quaterniond a = ExpSo3(Eigen::Vector3d(0.1, 0.0, 0.0));
  const OrientationTrack track = *OrientationTrack::Create(
      {0.0, 1.0}, {a, Eigen::Quaterniond(-a.w(), -a.x(), -a.y(), -a.z())});
  EXPECT_LT(track.CameraFromWorld(0.5)->angularDistance(a.conjugate()), 1e-7);
}

TEST(OrientationTrack, SpanIsHalfOpen) {
  const OrientationTrack track = ConstantRate({0.0, 0.0, 1.0}, {1.0, 2.0, 3.0});
  EXPECT_EQ(track.start_s(), 1.0);
  EXPECT_EQ(track.end_s(), 3.0);
  EXPECT_TRUE(track.CameraFromWorld(1.0));
  EXPECT_TRUE(track.CameraFromWorld(std::nextafter(3.0, 0.0)));
  EXPECT_FALSE(track.CameraFromWorld(3.0));
  EXPECT_TRUE(track.Covers(2.5, 1.0));
  EXPECT_FALSE(track.Covers(1.5, 3.0));
}

TEST(OrientationTrack, RefusesTimeBeforeFirstSample) {
  const OrientationTrack track = ConstantRate({0.0, 0.0, 1.0}, {1.0, 2.0});
  EXPECT_FALSE(track.CameraFromWorld(std::nextafter(1.0, 0.0)));
  EXPECT_FALSE(track.CameraFromWorld(std::numeric_limits<double>::quiet_NaN()));
}

// t_video = t_gyro + offset: a gyro clock that is 10 ms behind gets a positive offset.
TEST(OrientationTrack, OffsetMovesTheSamplesLater) {
  const Eigen::Vector3d rate(0.0, 1.0, 0.0);
  const OrientationTrack gyro = ConstantRate(rate, {0.0, 1.0, 2.0});
  const OrientationTrack video = gyro.WithOffset(0.010);
  EXPECT_LT(video.CameraFromWorld(0.510)->angularDistance(*gyro.CameraFromWorld(0.500)), 1e-7);
  EXPECT_FALSE(video.CameraFromWorld(0.005));
  EXPECT_TRUE(video.CameraFromWorld(2.005));
}

TEST(OrientationTrack, KnowsNothingInsideAGap) {
  std::vector<Eigen::Quaterniond> still(5, Eigen::Quaterniond::Identity());
  const OrientationTrack track =
      OrientationTrack::Create({0.0, 1.0, 2.0, 3.0, 4.0}, still, {{1.0, 2.0}, {3.0, 3.5}})
          ->WithOffset(10.0);
  EXPECT_TRUE(track.CameraFromWorld(11.0));
  EXPECT_FALSE(track.CameraFromWorld(11.5));
  EXPECT_TRUE(track.CameraFromWorld(12.0));
  EXPECT_FALSE(track.CameraFromWorld(13.2));
  EXPECT_TRUE(track.Covers(12.0, 13.0));
  EXPECT_FALSE(track.Covers(10.5, 12.5));
  EXPECT_FALSE(track.MeanRate(10.5, 12.5));
}

TEST(OrientationTrack, MeanRateIsTheBodyRate) {
  const Eigen::Vector3d rate(0.3, -0.7, 0.2);
  const OrientationTrack track = ConstantRate(rate, {0.0, 0.1, 0.2, 0.3, 0.4});
  EXPECT_LT((*track.MeanRate(0.05, 0.37) - rate).norm(), 1e-9);
  EXPECT_FALSE(track.MeanRate(0.2, 0.2));
  EXPECT_FALSE(track.MeanRate(0.2, 0.5));
}

TEST(OrientationTrack, AnchorContinuesToTheNextSample) {
  const Eigen::Vector3d rate(0.3, -0.7, 0.2);
  const OrientationTrack track = ConstantRate(rate, {0.0, 0.1, 0.2, 0.3}).WithOffset(1.0);
  const OrientationAnchor anchor = track.AnchorAt(1.15);
  EXPECT_NEAR(anchor.time_s, 1.1, 1e-12);
  EXPECT_LT((anchor.rate_rad_s - rate).norm(), 1e-9);
  const Eigen::Quaterniond continued =
      anchor.world_from_camera *
      ExpSo3(Eigen::Vector3d(anchor.rate_rad_s * (1.15 - anchor.time_s)));
  EXPECT_LT(continued.conjugate().angularDistance(*track.CameraFromWorld(1.15)), 1e-7);
  EXPECT_NEAR(track.AnchorAt(0.0).time_s, 1.0, 1e-12);
  EXPECT_NEAR(track.AnchorAt(9.0).time_s, 1.2, 1e-12);
}

TEST(OrientationTrack, CreateNamesTheBrokenSample) {
  const Eigen::Quaterniond one = Eigen::Quaterniond::Identity();
  EXPECT_FALSE(OrientationTrack::Create({0.0}, {one}));
  EXPECT_FALSE(OrientationTrack::Create({0.0, 1.0}, {one}));
  const auto backwards = OrientationTrack::Create({0.0, 1.0, 1.0}, {one, one, one});
  ASSERT_FALSE(backwards);
  EXPECT_EQ(backwards.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(backwards.error().message, ::testing::HasSubstr("sample 2"));
  const auto empty = OrientationTrack::Create({0.0, 1.0}, {one, Eigen::Quaterniond(0, 0, 0, 0)});
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().message, ::testing::HasSubstr("sample 1"));
}

}  // namespace
}  // namespace rsstab::igf
