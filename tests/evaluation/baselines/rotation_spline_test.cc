// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/rotation_spline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/evaluation/baselines/moving_frames.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::MeanDifference;
using rsstab::testing::MovingFrames;

// Tracks of hard-edged patches are good to a few tenths of a pixel.
constexpr double kTrackNoise_px = 0.4;
// The outermost rows have tracks on one side only, and as a reference they shift everything.
constexpr double kAtTheEdge_px = 1.0;

// A shaking turn: 8 px of displacement at the top of the picture.
Eigen::Vector3d Shake(double t) {
  return {0.03 * std::sin(40.0 * t), 2.5 * t + 0.02 * std::sin(60.0 * t + 1.0), 0.8 * t};
}

TEST(RotationSpline, TracksTellTheMotionInsideTheFrame) {
  const MovingFrames clip(Shake);
  const MotionField none(clip.truth.width(), clip.truth.height(), clip.truth.columns(),
                         clip.truth.rows());
  ASSERT_GT(MeanDifference(none, clip.truth), 3.0);
  RotationSplineMethod method;
  const auto three = clip.Ask(method, &clip.frames[0], &clip.frames[2]);
  ASSERT_TRUE(three) << three.error().message;
  EXPECT_LT(MeanDifference(three->field, clip.truth), kTrackNoise_px);
  // Two frames are enough, on either side.
  const auto earlier = clip.Ask(method, &clip.frames[0], nullptr);
  const auto later = clip.Ask(method, nullptr, &clip.frames[2]);
  ASSERT_TRUE(earlier && later);
  EXPECT_LT(MeanDifference(earlier->field, clip.truth), 2.0 * kTrackNoise_px);
  EXPECT_LT(MeanDifference(later->field, clip.truth), 2.0 * kTrackNoise_px);
  // Time run backwards is another motion.
  const auto reversed = clip.Ask(method, &clip.frames[2], &clip.frames[0]);
  if (reversed) {
    EXPECT_GT(MeanDifference(reversed->field, clip.truth), 3.0);
  }
}

TEST(RotationSpline, FirstRowAndBottomToTop) {
  const MovingFrames clip(Shake, -0.02, 0.0);
  RotationSplineMethod method;
  const auto answer = clip.Ask(method, &clip.frames[0], &clip.frames[2]);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->field.reference_row(), 0.0);
  EXPECT_LT(MeanDifference(answer->field, clip.truth), kAtTheEdge_px);
}

TEST(RotationSpline, SaysWhatItLacks) {
  const MovingFrames clip([](double) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); });
  RotationSplineMethod method;
  EXPECT_EQ(clip.Ask(method, nullptr, nullptr).error().code, ErrorCode::kUnsupported);
  const Frame flat = rsstab::testing::MakePhoto(320, 240, [](int, int) { return 90.0; });
  EXPECT_EQ(clip.Ask(method, &flat, nullptr).error().code, ErrorCode::kUntrustworthy);
  MovingFrames unknown = clip;
  unknown.camera.readout_s.reset();
  EXPECT_EQ(unknown.Ask(method, &clip.frames[0], nullptr).error().code, ErrorCode::kUnsupported);
  // A camera at rest: nothing to take out.
  const auto still = clip.Ask(method, &clip.frames[0], nullptr);
  ASSERT_TRUE(still);
  EXPECT_LT(still->field.MaxLength(), kTrackNoise_px);
}

}  // namespace
}  // namespace rsstab::evaluation
