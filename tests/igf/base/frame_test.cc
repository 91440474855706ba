// SPDX-License-Identifier: Apache-2.0
#include "igf/base/frame.h"

#include <gtest/gtest.h>

namespace rsstab {
namespace {

TEST(Frame, OddSizesRoundChromaUp) {
  const auto frame = AllocateFrame(Yuv420Layout(), 17, 13);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->planes[0].width, 17);
  EXPECT_EQ(frame->planes[1].width, 9);
  EXPECT_EQ(frame->planes[2].height, 7);
}

TEST(Frame, DeepSamplesTakeTwoBytes) {
  const auto frame = AllocateFrame(Yuv420Layout(10), 64, 2);
  ASSERT_TRUE(frame);
  EXPECT_GE(frame->planes[0].stride, 128);
}

TEST(Frame, RefusesImpossibleSizesAndLayouts) {
  EXPECT_FALSE(AllocateFrame(Yuv420Layout(), 0, 4));
  EXPECT_FALSE(AllocateFrame(Yuv420Layout(), 4, 70000));
  EXPECT_FALSE(AllocateFrame(Yuv420Layout(7), 4, 4));
}

TEST(Frame, BlackFollowsRangeAndDepth) {
  PixelLayout layout = Yuv420Layout(10);
  EXPECT_EQ(layout.BlackLevel(0, 0), 64);
  EXPECT_EQ(layout.BlackLevel(1, 0), 512);
  layout.full_range = true;
  EXPECT_EQ(layout.BlackLevel(0, 0), 0);
  EXPECT_EQ(RgbaLayout().BlackLevel(0, 3), 255);
}

TEST(Frame, SemiPlanarChromaIsOnePlane) {
  PixelLayout nv12 = Yuv420Layout();
  nv12.num_planes = 2;
  nv12.channels = {1, 2, 1, 1};
  EXPECT_TRUE(nv12.IsChroma(1));
  EXPECT_EQ(nv12.PlaneWidth(1, 5), 3);
}

}  // namespace
}  // namespace rsstab
