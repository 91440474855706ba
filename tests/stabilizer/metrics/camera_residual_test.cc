// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/camera_residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "igf/base/rotation.h"
#include "tests/stabilizer/metrics/textured_picture.h"

namespace rsstab::stabilizer {
namespace {

using testing::Look;
using testing::MakeScene;
using testing::ViewOf;

constexpr double kFocal = 554.0;  // 60 degrees wide

Camera TestCamera() {
  return Camera::Pinhole(testing::kPictureWidth, testing::kPictureHeight, kFocal);
}

// K R K^-1 Z: where a pixel of a picture zoomed by 1 / zoom and turned is in the twin.
Eigen::Matrix3d TwinFromPicture(const Eigen::Vector3d& turn, double zoom) {
  const Eigen::Matrix3d k = TestCamera().K();
  Eigen::Matrix3d zoomed = Eigen::Vector3d(zoom, zoom, 1.0).asDiagonal();
  return k * ExpSo3(turn).toRotationMatrix() * zoomed * k.inverse();
}

std::vector<PointMatch> GridMatches(const Eigen::Matrix3d& twin_from_picture) {
  std::vector<PointMatch> matches;
  for (int y = 10; y < testing::kPictureHeight; y += 20) {
    for (int x = 10; x < testing::kPictureWidth; x += 20) {
      const Eigen::Vector2d from(x, y);
      matches.push_back({from.cast<float>(), Project(twin_from_picture, from).cast<float>()});
    }
  }
  return matches;
}

TEST(FitRotationZoom, FindsTurnAndZoomWithTheirSigns) {
  const Eigen::Vector3d turn(0.03, -0.05, 0.02);
  auto matches = GridMatches(TwinFromPicture(turn, 0.85));
  for (std::size_t i = 0; i < matches.size(); i += 10) {
    matches[i].to.x() += 20.0F;  // wrong
  }
  const auto fit = FitRotationZoom(matches, TestCamera(), TestCamera());
  ASSERT_TRUE(fit);
  EXPECT_LT((LogSo3(fit->to_from_from) - turn).norm(), 1e-5);
  EXPECT_NEAR(fit->zoom, 0.85, 1e-5);
  EXPECT_LT(fit->rms_px, 1e-3);  // float matches
  EXPECT_EQ(fit->inliers, matches.size() - (matches.size() + 9) / 10);
  EXPECT_EQ(fit->inlier[0], 0);
  EXPECT_EQ(fit->inlier[1], 1);
}

TEST(FitRotationZoom, RefusesInSilenceWhatLiesBehindTheCamera) {
  auto matches = GridMatches(Eigen::Matrix3d::Identity());
  for (PointMatch& match : matches) {
    match.to.x() += 3.0F * static_cast<float>(kFocal);  // as a turn: 3 rad
  }
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(FitRotationZoom(matches, TestCamera(), TestCamera()));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(FitRotationZoom, DoesNotExplainAShiftOrAStretch) {
  // A shift of 8 px is a turn of 8/f but for the perspective that goes with it, 8 (x / f)^2 along
  // x.
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift(0, 2) = 8.0;
  EXPECT_GT(FitRotationZoom(GridMatches(shift), TestCamera(), TestCamera())->rms_px, 0.3);
  // A stretch by 1%: best zoom 0.5%, so +-0.5% of the coordinates is left.
  Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
  stretch(0, 0) = 1.01;
  EXPECT_GT(FitRotationZoom(GridMatches(stretch), TestCamera(), TestCamera())->rms_px, 0.3);
}

TEST(FitRotationZoom, WorksBetweenPictureSizes) {
  auto matches = GridMatches(TwinFromPicture({0.0, 0.02, 0.0}, 0.9));
  for (PointMatch& match : matches) {
    match.from = (match.from.array() + 0.5F) * 2.0F - 0.5F;
  }
  const auto fit = FitRotationZoom(matches, TestCamera().Rescaled(1280, 720), TestCamera());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->zoom, 0.9, 1e-5);
  EXPECT_LT(fit->rms_px, 1e-3);
}

TEST(TruthMeter, PerfectlyTurnedPicturesHaveNoResidual) {
  const cv::Mat scene = MakeScene();
  const cv::Mat twin = Look(scene, Eigen::Matrix3d::Identity());
  auto meter = TruthMeter::Create(TestCamera()).value();
  for (const double zoom : {0.8, 1.0}) {
    // About 60 px of shift and 3 degrees of roll: beyond what a tracker bridges.
    const cv::Mat picture = Look(scene, TwinFromPicture({0.03, 0.1, 0.05}, zoom));
    ASSERT_TRUE(meter.Push(ViewOf(picture), ViewOf(twin)));
  }
  const TruthMetrics metrics = meter.Measure();
  EXPECT_EQ(metrics.unaligned, 0);
  EXPECT_GT(metrics.matches_per_frame, 200.0);
  EXPECT_LT(metrics.camera_residual.value(), 0.05);  // tracking and resampling
  EXPECT_LT(metrics.bend.value(), 0.05);
}

TEST(TruthMeter, SeesSkewWhereBendDoesNot) {
  // Rows sheared by 1% of their distance from the middle: an affine map, no rotation or zoom.
  constexpr double kShear = 0.01;
  const cv::Mat scene = MakeScene();
  const cv::Mat twin = Look(scene, Eigen::Matrix3d::Identity());
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = kShear;
  shear(0, 2) = -kShear * testing::PictureCentre().y();
  auto meter = TruthMeter::Create(TestCamera()).value();
  ASSERT_TRUE(meter.Push(ViewOf(Look(scene, shear)), ViewOf(twin)));
  const TruthMetrics metrics = meter.Measure();
  // The best roll about the centre, u of the shear, leaves (k - u) y along x and u x along y: with
  // y evenly in +-170 and x in +-310, u = k var(y) / (var(x) + var(y)).
  const double var_x = 310.0 * 310.0 / 3.0;
  const double var_y = 170.0 * 170.0 / 3.0;
  const double roll = kShear * var_y / (var_x + var_y);
  const double expected =
      std::sqrt((kShear - roll) * (kShear - roll) * var_y + roll * roll * var_x);
  EXPECT_NEAR(metrics.camera_residual.value(), expected, 0.05 * expected);
  EXPECT_NEAR(metrics.worst_frame.value(), metrics.camera_residual.value(), 1e-9);
  ASSERT_EQ(metrics.frame_residual.size(), 1U);
  EXPECT_NEAR(metrics.frame_residual[0], metrics.camera_residual.value(), 1e-6);  // stored as float
  EXPECT_LT(metrics.bend.value(), 0.05);
}

TEST(TruthMeter, SeesBendingRows) {
  constexpr double kAmplitude = 1.2;
  const cv::Mat scene = MakeScene();
  const cv::Mat twin = Look(scene, Eigen::Matrix3d::Identity());
  const cv::Mat picture = testing::LookBent(scene, [](const Eigen::Vector2d& p) {
    const double turn = 2.0 * std::numbers::pi * 3.0 * p.y() / testing::kPictureHeight;
    return Eigen::Vector2d(p.x() + kAmplitude * std::sin(turn), p.y());
  });
  auto meter = TruthMeter::Create(TestCamera()).value();
  ASSERT_TRUE(meter.Push(ViewOf(picture), ViewOf(twin)));
  // No homography explains three turns but for 7% of their energy; the tracker's window takes 3%.
  const double expected = kAmplitude / std::numbers::sqrt2 * std::sqrt(1.0 - 0.068);
  EXPECT_NEAR(meter.Measure().bend.value(), expected, 0.06 * expected);
  EXPECT_GE(meter.Measure().camera_residual.value(), meter.Measure().bend.value());
}

TEST(TruthMeter, RefusesABrokenCameraAndCountsWhatItCannotAlign) {
  EXPECT_FALSE(TruthMeter::Create(Camera{}));
  const cv::Mat flat(360, 640, CV_8U, cv::Scalar(80));
  auto meter = TruthMeter::Create(TestCamera()).value();
  ASSERT_TRUE(meter.Push(ViewOf(flat), ViewOf(flat)));
  EXPECT_EQ(meter.Measure().unaligned, 1);
  EXPECT_TRUE(std::isnan(meter.Measure().frame_residual.at(0)));
  EXPECT_FALSE(meter.Measure().camera_residual);
}

}  // namespace
}  // namespace rsstab::stabilizer
