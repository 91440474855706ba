// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/exhibit_picker.h"

#include <gtest/gtest.h>

#include <cstring>

#include "cli/pages/shake_scale.h"

namespace rsstab::cli {
namespace {

// A grey frame whose brightness tells its number.
Frame Numbered(std::int64_t index) {
  Frame frame = *AllocateFrame(GrayLayout(), 64, 36);
  const MutablePlaneView& plane = frame.planes[0];
  std::memset(plane.data, static_cast<int>(index % 200),
              static_cast<std::size_t>(plane.stride * plane.height));
  return frame;
}

Status Push(ExhibitPicker& picker, std::int64_t index, std::optional<double> shake,
            std::optional<double> rs) {
  const Frame frame = Numbered(index);
  ExhibitCandidate candidate;
  candidate.index = index;
  candidate.time_s = 0.04 * static_cast<double>(index);
  candidate.shake_px = shake;
  candidate.rs_px = rs;
  candidate.input = candidate.output = frame.View();
  return picker.Push(candidate);
}

TEST(ExhibitPicker, ShowsTheExtremesAndAnAverageFrame) {
  ExhibitPicker picker(report::ColorMatrix::kBt709);
  constexpr int kFrames = 1000;
  for (int n = 0; n < kFrames; ++n) {
    const double shake = n == 700 ? 50.0 : 0.01 * n;
    const double rs = n == 300 ? 9.0 : 1.0;
    ASSERT_TRUE(Push(picker, n, shake, rs));
  }
  const auto exhibits = picker.Finish();
  ASSERT_EQ(exhibits.size(), 3U);
  EXPECT_EQ(exhibits[0].index, 300);
  EXPECT_EQ(exhibits[0].reason, "most rolling shutter");
  EXPECT_EQ(exhibits[1].index, 700);
  EXPECT_EQ(exhibits[1].reason, "most shake");
  // The median is 5.0; at least four evenly spaced frames were there to choose from.
  EXPECT_NEAR(exhibits[2].shake_px.value(), 5.0, 1.3);
  // The picture is the frame's own (limited range is stretched).
  const int shown = exhibits[2].input.planes[0].data[0];
  const Frame same = Numbered(exhibits[2].index);
  EXPECT_EQ(shown, report::MakePreview(same.View(), 960)->planes[0].data[0]);
}

TEST(ExhibitPicker, ShowsAFrameOnce) {
  ExhibitPicker picker(report::ColorMatrix::kBt709);
  ASSERT_TRUE(Push(picker, 0, std::nullopt, 2.0));
  ASSERT_TRUE(Push(picker, 1, 3.0, 4.0));
  const auto exhibits = picker.Finish();
  ASSERT_EQ(exhibits.size(), 1U);
  EXPECT_EQ(exhibits[0].reason, "most rolling shutter, most shake, average shake");
}

TEST(ExhibitPicker, ClipsWithoutMotionHaveAFrame) {
  ExhibitPicker picker(report::ColorMatrix::kBt709);
  ASSERT_TRUE(Push(picker, 0, std::nullopt, std::nullopt));
  EXPECT_EQ(picker.Finish().size(), 1U);
  EXPECT_TRUE(picker.Finish().empty());
}

TEST(ShakeScale, IsTheChangeOfTheMotion) {
  ShakeScale scale;
  EXPECT_FALSE(scale.Next(std::nullopt));
  EXPECT_FALSE(scale.Next(Eigen::Vector2d(3, 4)));
  EXPECT_EQ(scale.Next(Eigen::Vector2d(0, 0)), 5.0);
  EXPECT_FALSE(scale.Next(std::nullopt));
  EXPECT_FALSE(scale.Next(Eigen::Vector2d(1, 1)));
}

}  // namespace
}  // namespace rsstab::cli
