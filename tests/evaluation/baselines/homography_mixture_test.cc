// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/homography_mixture.h"

#include <gtest/gtest.h>

#include "igf/base/homography.h"
#include "tests/evaluation/baselines/moving_frames.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::kFrameIntervalS;
using rsstab::testing::MeanDifference;
using rsstab::testing::MovingFrames;

constexpr double kReadoutS = 0.02;

Eigen::Vector3d SteadyTurn(double t) { return Eigen::Vector3d(0.7, 2.5, 1.0) * t; }

TEST(HomographyMixture, FollowsAMotionThatDiffersDownTheRows) {
  PointTracks tracks;
  tracks.width = 640;
  tracks.height = 480;
  tracks.from_time_s = 0.0;
  tracks.to_time_s = 1.0;
  // Rows move further to the right the lower they are, and every tenth match is wild.
  const auto moved = [](const Eigen::Vector2f& p) -> Eigen::Vector2f {
    return p + Eigen::Vector2f(5.0F + 12.0F * p.y() / 480.0F, -3.0F);
  };
  int count = 0;
  for (float y = 8.0F; y < 480.0F; y += 16.0F) {
    for (float x = 8.0F; x < 640.0F; x += 16.0F, ++count) {
      PointMatch match;
      match.from = {x, y};
      match.to = moved(match.from);
      if (count % 10 == 0) {
        match.to.x() += 60.0F;
      }
      tracks.matches.push_back(match);
    }
  }
  const auto blocks = FitHomographyMixture(tracks, true);
  ASSERT_EQ(blocks.size(), 10U);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Eigen::Vector2f middle(320.0F, 48.0F * (static_cast<float>(k) + 0.5F));
    // Blocks are as wide as their weights, which smears a ramp at its ends.
    EXPECT_LT((Project(blocks[k], middle.cast<double>()) - moved(middle).cast<double>()).norm(),
              0.6)
        << k;
  }
}

TEST(HomographyMixture, ASteadyTurnIsTakenOut) {
  // What a guess of the motion between rows from that between frames can reach.
  constexpr double kClose_px = 0.4;
  const MovingFrames clip(SteadyTurn, kReadoutS);
  const MotionField none(clip.truth.width(), clip.truth.height(), clip.truth.columns(),
                         clip.truth.rows());
  ASSERT_GT(MeanDifference(none, clip.truth), 3.0);
  HomographyMixtureMethod method(kReadoutS / kFrameIntervalS);
  const auto three = clip.Ask(method, &clip.frames[0], &clip.frames[2]);
  ASSERT_TRUE(three) << three.error().message;
  EXPECT_LT(MeanDifference(three->field, clip.truth), kClose_px);
  const auto earlier = clip.Ask(method, &clip.frames[0], nullptr);
  const auto later = clip.Ask(method, nullptr, &clip.frames[2]);
  ASSERT_TRUE(earlier && later);
  EXPECT_LT(MeanDifference(earlier->field, clip.truth), kClose_px);
  EXPECT_LT(MeanDifference(later->field, clip.truth), kClose_px);
  // Frames in the wrong order turn the other way.
  const auto reversed = clip.Ask(method, &clip.frames[2], &clip.frames[0]);
  ASSERT_TRUE(reversed);
  EXPECT_GT(MeanDifference(reversed->field, clip.truth), 1.5 * MeanDifference(none, clip.truth));
}

TEST(HomographyMixture, ToldFromTheFirstRow) {
  const MovingFrames clip(SteadyTurn, kReadoutS, 0.0);
  HomographyMixtureMethod method(kReadoutS / kFrameIntervalS);
  const auto answer = clip.Ask(method, &clip.frames[0], nullptr);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->field.reference_row(), 0.0);
  EXPECT_LT(MeanDifference(answer->field, clip.truth), 0.8);
}

TEST(HomographyMixture, SaysWhatItLacks) {
  const MovingFrames clip([](double) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); });
  HomographyMixtureMethod method;
  EXPECT_EQ(clip.Ask(method, nullptr, nullptr).error().code, ErrorCode::kUnsupported);
  const Frame flat = rsstab::testing::MakePhoto(320, 240, [](int, int) { return 90.0; });
  EXPECT_EQ(clip.Ask(method, &flat, nullptr).error().code, ErrorCode::kUntrustworthy);
}

}  // namespace
}  // namespace rsstab::evaluation
