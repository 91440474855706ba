// SPDX-License-Identifier: Apache-2.0
#include "cli/report/preview.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace rsstab::report {
namespace {

using Rgb = std::array<int, 3>;

Frame Uniform(const PixelLayout& layout, int width, int height, const std::array<int, 3>& codes) {
  Frame frame = *AllocateFrame(layout, width, height);
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    const MutablePlaneView& plane = frame.planes[index];
    for (int y = 0; y < plane.height; ++y) {
      for (int x = 0; x < plane.width * layout.channels[index]; ++x) {
        const int code = codes[index + static_cast<std::size_t>(x % layout.channels[index])];
        std::uint8_t* row = plane.data + y * plane.stride;
        if (layout.BytesPerSample() == 1) {
          row[x] = static_cast<std::uint8_t>(code);
        } else {
          const auto sample = static_cast<std::uint16_t>(code);
          std::memcpy(row + 2 * x, &sample, 2);
        }
      }
    }
  }
  return frame;
}

Rgb ColorOf(const Frame& frame, ColorMatrix matrix) {
  const auto preview = MakePreview(frame.View(), 16, matrix);
  EXPECT_TRUE(preview);
  const std::uint8_t* pixel = preview->planes[0].data;
  return {pixel[0], pixel[1], pixel[2]};
}

// Codes are whole numbers: each colour comes back within two levels.
constexpr int kRounding = 2;
void ExpectNear(const Rgb& seen, const Rgb& expected) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(seen[i], expected[i], kRounding) << "channel " << i;
  }
}

TEST(MakePreview, ColoursAreThoseOfTheStandards) {
  // Pure red in limited range: BT.601 (81, 90, 240), BT.709 (63, 102, 240); and at 10 bits.
  ExpectNear(ColorOf(Uniform(Yuv420Layout(), 32, 18, {81, 90, 240}), ColorMatrix::kBt601),
             {255, 0, 0});
  ExpectNear(ColorOf(Uniform(Yuv420Layout(), 32, 18, {63, 102, 240}), ColorMatrix::kBt709),
             {255, 0, 0});
  ExpectNear(
      ColorOf(Uniform(Yuv420Layout(10), 32, 18, {63 * 4, 102 * 4, 240 * 4}), ColorMatrix::kBt709),
      {255, 0, 0});
  // Pure blue in BT.709.
  ExpectNear(ColorOf(Uniform(Yuv420Layout(), 32, 18, {32, 240, 118}), ColorMatrix::kBt709),
             {0, 0, 255});
}

TEST(MakePreview, KnowsGreyAndSemiPlanarAndRgb) {
  PixelLayout nv12 = Yuv420Layout();
  nv12.num_planes = 2;
  nv12.channels = {1, 2, 1, 1};
  ExpectNear(ColorOf(Uniform(nv12, 32, 18, {63, 102, 240}), ColorMatrix::kBt709), {255, 0, 0});
  PixelLayout gray = GrayLayout();
  gray.full_range = false;
  ExpectNear(ColorOf(Uniform(gray, 32, 18, {235, 0, 0}), ColorMatrix::kBt709), {255, 255, 255});
  PixelLayout rgb = RgbaLayout();
  rgb.channels[0] = 3;
  ExpectNear(ColorOf(Uniform(rgb, 32, 18, {10, 120, 250}), ColorMatrix::kBt709), {10, 120, 250});
}

TEST(MakePreview, ShrinksAndNeverEnlarges) {
  const Frame frame = Uniform(Yuv420Layout(), 64, 36, {100, 128, 128});
  const auto small = MakePreview(frame.View(), 32);
  ASSERT_TRUE(small);
  EXPECT_EQ(small->width, 32);
  EXPECT_EQ(small->height, 18);
  const auto same = MakePreview(frame.View(), 640);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->width, 64);
  EXPECT_FALSE(MakePreview(FrameView(), 640));
}

TEST(DataUri, TellsItsFormat) {
  const auto picture = MakePreview(Uniform(Yuv420Layout(), 32, 18, {100, 90, 200}).View(), 16);
  ASSERT_TRUE(picture);
  EXPECT_EQ(DataUri(picture->View(), PictureFormat::kWebp)->rfind("data:image/webp;base64,", 0),
            0U);
  EXPECT_EQ(DataUri(picture->View(), PictureFormat::kPng)->rfind("data:image/png;base64,", 0), 0U);
  EXPECT_FALSE(DataUri(FrameView(), PictureFormat::kPng));
}

TEST(ColorMatrixOf, AssumesWhatPlayersDo) {
  EXPECT_EQ(ColorMatrixOf("bt709", 480), ColorMatrix::kBt709);
  EXPECT_EQ(ColorMatrixOf("bt2020nc", 480), ColorMatrix::kBt2020);
  EXPECT_EQ(ColorMatrixOf("", 480), ColorMatrix::kBt601);
  EXPECT_EQ(ColorMatrixOf("", 1080), ColorMatrix::kBt709);
}

}  // namespace
}  // namespace rsstab::report
