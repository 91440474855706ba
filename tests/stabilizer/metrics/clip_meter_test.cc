// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "stabilizer/quality_metrics.h"
#include "tests/stabilizer/metrics/textured_picture.h"

namespace rsstab::stabilizer {
namespace {

using testing::AboutCentre;
using testing::Look;
using testing::MakeScene;
using testing::ViewOf;

constexpr double kFps = 30.0;

double Phase(int n, double period) { return 2.0 * std::numbers::pi * n / period; }

TEST(ClipMeter, MeasuresAKnownSwing) {
  constexpr int kFrames = 61;
  constexpr int kPeriod = 10;
  constexpr double kAmplitude = 4.0;
  const cv::Mat scene = MakeScene();
  ClipMeter meter;
  for (int n = 0; n < kFrames; ++n) {
    const Eigen::Vector2d shift(kAmplitude * std::sin(Phase(n, kPeriod)), 0.0);
    const cv::Mat picture = Look(scene, AboutCentre(Eigen::Matrix2d::Identity(), shift));
    ASSERT_TRUE(meter.Push(ViewOf(picture)));
  }
  const ClipMetrics metrics = meter.Measure(kFps);
  const double half = std::sin(std::numbers::pi / kPeriod);
  const double jitter = kAmplitude * 4.0 * half * half / std::numbers::sqrt2;
  EXPECT_EQ(metrics.frames, kFrames);
  EXPECT_EQ(metrics.unmeasured_motions, 0);
  EXPECT_GT(metrics.tracks_per_frame, 300.0);  // of 576 cells
  EXPECT_NEAR(metrics.jitter.value(), jitter, 0.02 * jitter);
  // 3 Hz: the 0.25 s Gaussian passes exp(-11), nothing. Not whole periods are summed: 5%.
  EXPECT_NEAR(metrics.shake.value(), kAmplitude / std::numbers::sqrt2, 0.05 * kAmplitude);
  EXPECT_LT(metrics.wobble.value(), 0.05);  // a shift is a homography: tracking noise only
  EXPECT_LT(metrics.row_wobble.value(), 0.02);
  EXPECT_LT(metrics.stability.value(), 0.1);  // six swings: the seventh frequency
  // A picture that looks further right shows its content further left.
  const auto path = meter.Path();
  ASSERT_EQ(path.size(), static_cast<std::size_t>(kFrames));
  for (const int n : {0, 2, 7, kFrames - 1}) {
    EXPECT_NEAR(path[static_cast<std::size_t>(n)].position.x(),
                -kAmplitude * std::sin(Phase(n, kPeriod)), 0.1);
  }
  EXPECT_NEAR((meter.LastStep().value() - (path[60].position - path[59].position)).norm(), 0.0,
              1e-9);
}

TEST(ClipMeter, SeesRowsShearedToAndFro) {
  // Rows displaced by +-a/2 sin(three turns over the height) in turn: a sin(..) from frame to
  // frame. A homography explains 6 / (pi 3)^2 = 7% of its energy (the slope).
  constexpr double kAmplitude = 1.5;
  const cv::Mat scene = MakeScene();
  ClipMeter meter;
  for (int n = 0; n < 6; ++n) {
    const double sign = n % 2 == 0 ? 0.5 : -0.5;
    const cv::Mat picture = testing::LookBent(scene, [&](const Eigen::Vector2d& p) {
      const double turn = Phase(3, testing::kPictureHeight) * p.y();
      return Eigen::Vector2d(p.x() + sign * kAmplitude * std::sin(turn), p.y());
    });
    ASSERT_TRUE(meter.Push(ViewOf(picture)));
  }
  const ClipMetrics metrics = meter.Measure(kFps);
  const double expected = kAmplitude / std::numbers::sqrt2 * std::sqrt(1.0 - 0.068);
  // The tracker's 15 px window averages over an eighth of a turn: 3% less; tracks keep off the
  // border, where the sine is small.
  EXPECT_NEAR(metrics.wobble.value(), expected, 0.06 * expected);
  // All of it is common to rows; a band of 20 px averages over a sixth of a turn: 5% less.
  EXPECT_NEAR(metrics.row_wobble.value(), expected, 0.1 * expected);
}

TEST(ClipMeter, FramesThatShowNothingAreNotMeasured) {
  const cv::Mat flat(120, 160, CV_8U, cv::Scalar(90));
  ClipMeter meter;
  for (int n = 0; n < 4; ++n) {
    ASSERT_TRUE(meter.Push(ViewOf(flat)));
  }
  const ClipMetrics metrics = meter.Measure(kFps);
  EXPECT_EQ(metrics.unmeasured_motions, 3);
  EXPECT_FALSE(metrics.jitter);
  EXPECT_FALSE(metrics.wobble);
  EXPECT_EQ(metrics.itf_db.value(), 60.0);  // alike
}

TEST(ClipMeter, ItfIsTheMeanPsnrOfNeighbours) {
  ClipMeter meter;
  for (const int level : {100, 110, 105}) {
    const cv::Mat flat(20, 30, CV_8U, cv::Scalar(level));
    ASSERT_TRUE(meter.Push(ViewOf(flat)));
  }
  const double expected = 10.0 * (std::log10(255.0 / 10.0) + std::log10(255.0 / 5.0));
  EXPECT_NEAR(meter.Measure(kFps).itf_db.value(), expected, 1e-9);
}

TEST(ClipMeter, FewOrTinyFrames) {
  ClipMeter meter;
  EXPECT_EQ(meter.Measure(kFps).frames, 0);
  const cv::Mat dot(1, 1, CV_8U, cv::Scalar(90));
  ASSERT_TRUE(meter.Push(ViewOf(dot)));
  EXPECT_FALSE(meter.Measure(kFps).itf_db);
  ASSERT_TRUE(meter.Push(ViewOf(dot)));
  EXPECT_TRUE(meter.Measure(kFps).itf_db);
  const cv::Mat other(2, 1, CV_8U, cv::Scalar(90));
  EXPECT_EQ(meter.Push(ViewOf(other)).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(meter.Push(FrameView{}).error().code, ErrorCode::kInvalidArgument);
}

TEST(ClipMeter, TellsTheSameOfALargerPicture) {
  const cv::Mat scene = MakeScene();
  ClipMeter small_meter;
  ClipMeter large_meter;
  for (int n = 0; n < 14; ++n) {
    const Eigen::Vector2d shift(3.0 * std::sin(1.3 * n), 2.0 * std::cos(0.9 * n));
    const cv::Mat small = Look(scene, AboutCentre(Eigen::Matrix2d::Identity(), shift));
    cv::Mat large;
    cv::resize(small, large, {}, 2.0, 2.0, cv::INTER_CUBIC);
    ASSERT_TRUE(small_meter.Push(ViewOf(small)));
    ASSERT_TRUE(large_meter.Push(ViewOf(large)));
  }
  EXPECT_NEAR(small_meter.Measure(kFps).jitter.value(), large_meter.Measure(kFps).jitter.value(),
              0.02);  // resampling
}

}  // namespace
}  // namespace rsstab::stabilizer
