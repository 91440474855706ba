// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/crop_planner.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rsstab::stabilizer {
namespace {

std::vector<double> Plan(std::size_t reach, const std::vector<double>& allowed,
                         std::size_t cut = 1U << 30) {
  ZoomPlanner planner(reach);
  std::vector<double> planned;
  const auto take = [&] {
    for (const double c : planner.TakeReady()) {
      planned.push_back(c);
    }
  };
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    planner.Push(allowed[i], i == 0 || i == cut);
    take();
  }
  planner.Finish();
  take();
  return planned;
}

TEST(ZoomPlanner, NeverExceedsWhatIsAllowed) {
  std::vector<double> allowed;
  for (int i = 0; i < 500; ++i) {
    allowed.push_back(0.9 + 0.1 * std::sin(0.7 * i) * std::cos(0.13 * i));
  }
  for (const std::size_t reach : {0U, 1U, 7U, 30U, 400U}) {
    const auto planned = Plan(reach, allowed);
    ASSERT_EQ(planned.size(), allowed.size());
    for (std::size_t i = 0; i < planned.size(); ++i) {
      EXPECT_LE(planned[i], allowed[i] + 1e-12) << reach << " " << i;
    }
  }
}

TEST(ZoomPlanner, ChangesSlowlyAroundOneBadFrameAndIsFreeElsewhere) {
  std::vector<double> allowed(400, 1.0);
  allowed[200] = 0.7;
  const auto planned = Plan(30, allowed);
  for (std::size_t i = 1; i < planned.size(); ++i) {
    EXPECT_LT(std::abs(planned[i] - planned[i - 1]), 0.02);
  }
  EXPECT_NEAR(planned[200], 0.7, 1e-9);
  EXPECT_EQ(planned[100], 1.0);
  EXPECT_EQ(planned[300], 1.0);
}

TEST(ZoomPlanner, ACutHidesTheJump) {
  std::vector<double> allowed(100, 1.0);
  for (std::size_t i = 50; i < 100; ++i) {
    allowed[i] = 0.8;
  }
  const auto planned = Plan(30, allowed, 50);
  EXPECT_EQ(planned[49], 1.0);
  EXPECT_NEAR(planned[50], 0.8, 1e-12);
}

FrameWarp Shifted(double x, double y) {
  FrameWarp warp;
  warp.width = 641;
  warp.height = 361;
  warp.rectified_from_output(0, 2) = x;
  warp.rectified_from_output(1, 2) = y;
  return warp;
}

TEST(LargestCropRatio, IsOneWhenNothingMoves) {
  EXPECT_EQ(LargestCropRatio(Shifted(0.0, 0.0)), 1.0);
}

TEST(LargestCropRatio, FollowsFromTheShift) {
  // Half the width is 320: a shift of 32 px (and the planner's quarter pixel) leaves 90%.
  EXPECT_NEAR(LargestCropRatio(Shifted(32.0, 0.0)), 1.0 - 32.25 / 320.0, 2e-4);
  EXPECT_NEAR(LargestCropRatio(Shifted(0.0, -18.0)), 1.0 - 18.25 / 180.0, 2e-4);
  EXPECT_EQ(LargestCropRatio(Shifted(5000.0, 0.0)), kMinCropRatio);
}

TEST(LargestCropRatio, SeesTheReadoutMotion) {
  FrameWarp warp = Shifted(0.0, 0.0);
  warp.rs_field = MotionField(641, 361, 5, 9);
  for (int c = 0; c < 5; ++c) {
    warp.rs_field.At(c, 8) = {6.4F, 0.0F};  // the bottom row looks 6.4 px to the right
  }
  // The outline shrinks until its bottom corner is inside.
  const double ratio = LargestCropRatio(warp);
  EXPECT_LT(ratio, 1.0);
  EXPECT_GT(ratio, 1.0 - 6.8 / 320.0);
  EXPECT_LE(OverhangPx(ComposeBackwardMap(WithCrop(warp, ratio))), 0.0);
}

TEST(WithCrop, ZoomsAboutTheMiddle) {
  const FrameWarp warp = WithCrop(Shifted(0.0, 0.0), 0.5);
  const auto middle = SourcePosition(warp, {320.0, 180.0});
  const auto corner = SourcePosition(warp, {0.0, 0.0});
  EXPECT_NEAR(middle->x(), 320.0, 1e-9);
  EXPECT_NEAR(corner->x(), 160.0, 1e-9);
  EXPECT_NEAR(corner->y(), 90.0, 1e-9);
}

}  // namespace
}  // namespace rsstab::stabilizer
