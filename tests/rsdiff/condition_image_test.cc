// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/condition_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "rsdiff/orientation_planes.h"

namespace rsstab::rsdiff {
namespace {

constexpr Shape kRgbShape{3, 64, 64};

void SetSample(const Frame& frame, int plane, int x, int y, int channel, int value) {
  const auto index = static_cast<std::size_t>(plane);
  const MutablePlaneView& view = frame.planes[index];
  const int bytes = frame.layout.BytesPerSample();
  std::uint8_t* sample =
      view.data + y * view.stride + (x * frame.layout.channels[index] + channel) * bytes;
  if (bytes == 1) {
    *sample = static_cast<std::uint8_t>(value);
  } else {
    *reinterpret_cast<std::uint16_t*>(sample) = static_cast<std::uint16_t>(value);
  }
}

// Fills a plane; value(x, y, channel).
void FillPlane(const Frame& frame, int plane, const std::function<int(int, int, int)>& value) {
  const auto index = static_cast<std::size_t>(plane);
  for (int y = 0; y < frame.planes[index].height; ++y) {
    for (int x = 0; x < frame.planes[index].width; ++x) {
      for (int c = 0; c < frame.layout.channels[index]; ++c) {
        SetSample(frame, plane, x, y, c, value(x, y, c));
      }
    }
  }
}

Frame Flat(const PixelLayout& layout, int width, int height,
           const std::array<std::array<int, 4>, 3>& planes) {
  Frame frame = *AllocateFrame(layout, width, height);
  for (int p = 0; p < layout.num_planes; ++p) {
    FillPlane(frame, p, [&](int, int, int c) {
      return planes[static_cast<std::size_t>(p)][static_cast<std::size_t>(c)];
    });
  }
  return frame;
}

void ExpectRgb(const Frame& frame, double red, double green, double blue, double tolerance) {
  const auto condition = MakeCondition(frame.View(), ConditionKind::kRgb, kRgbShape);
  ASSERT_TRUE(condition) << condition.error().message;
  const std::array<double, 3> expected = {red, green, blue};
  for (std::size_t i = 0; i < condition->values.size(); ++i) {
    ASSERT_NEAR(condition->values[i], 2.0 * expected[i / (64 * 64)] - 1.0, tolerance) << i;
  }
}

TEST(MakeCondition, KnowsTheChannelsOfEveryRgbLayout) {
  constexpr double kExact = 1e-5;
  ExpectRgb(Flat(RgbaLayout(), 100, 80, {{{255, 51, 0, 9}}}), 1.0, 0.2, 0.0, kExact);
  PixelLayout planar;
  planar.is_rgb = true;
  planar.full_range = true;
  planar.bit_depth = 10;
  planar.chroma_shift_x = planar.chroma_shift_y = 0;
  // libav's planar RGB: green, blue, red.
  ExpectRgb(Flat(planar, 50, 90, {{{0}, {341}, {1023}}}), 1.0, 0.0, 341.0 / 1023.0, kExact);
  PixelLayout gray = GrayLayout(16);
  gray.full_range = true;
  ExpectRgb(Flat(gray, 30, 200, {{{13107}}}), 0.2, 0.2, 0.2, kExact);
}

// Red and blue as YUV: BT.601 limited range at 480 rows, BT.709 at 720.
TEST(MakeCondition, ConvertsYuv) {
  constexpr double kRounded = 0.012;  // half a level of 8-bit chroma, times 1.8
  PixelLayout layout = Yuv420Layout();
  ExpectRgb(Flat(layout, 640, 480, {{{81}, {90}, {240}}}), 1.0, 0.0, 0.0, kRounded);
  ExpectRgb(Flat(layout, 640, 480, {{{41}, {240}, {110}}}), 0.0, 0.0, 1.0, kRounded);
  ExpectRgb(Flat(layout, 1280, 720, {{{63}, {102}, {240}}}), 1.0, 0.0, 0.0, kRounded);
  ExpectRgb(Flat(layout, 1280, 720, {{{16}, {128}, {128}}}), 0.0, 0.0, 0.0, kRounded);
  ExpectRgb(Flat(layout, 1280, 720, {{{235}, {128}, {128}}}), 1.0, 1.0, 1.0, kRounded);
  ExpectRgb(Flat(Yuv420Layout(10), 1280, 720, {{{252}, {408}, {960}}}), 1.0, 0.0, 0.0, kRounded);
  layout.full_range = true;
  ExpectRgb(Flat(layout, 640, 480, {{{76}, {85}, {255}}}), 1.0, 0.0, 0.0, kRounded);
  PixelLayout semi_planar = Yuv420Layout();  // NV12
  semi_planar.num_planes = 2;
  semi_planar.channels = {1, 2, 1, 1};
  ExpectRgb(Flat(semi_planar, 641, 481, {{{81}, {90, 240}}}), 1.0, 0.0, 0.0, kRounded);
}

// Shrunk by area: every output pixel is the mean of the pixels it covers, at any phase.
TEST(MakeCondition, ShrinksByArea) {
  const Frame frame = *AllocateFrame(RgbaLayout(), 640, 128);
  FillPlane(frame, 0, [](int x, int y, int c) { return c == 0 ? (x % 10) * 20 : (y % 2) * 200; });
  const Tensor condition = *MakeCondition(frame.View(), ConditionKind::kRgb, kRgbShape);
  for (std::size_t i = 0; i < condition.values.size(); ++i) {
    const double mean = i < 64 * 64 ? 90.0 : 100.0;
    ASSERT_NEAR(condition.values[i], 2.0 * mean / 255.0 - 1.0, 0.005) << i;
  }
}

TEST(MakeCondition, PutsPixelsWhereTheyAre) {
  const Frame frame = *AllocateFrame(GrayLayout(), 256, 512);
  FillPlane(frame, 0, [](int x, int y, int) { return x >= 128 && y < 256 ? 235 : 16; });
  const Tensor condition = *MakeCondition(frame.View(), ConditionKind::kRgb, kRgbShape);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const float value = condition.values[static_cast<std::size_t>(row * 64 + column)];
      EXPECT_NEAR(value, column >= 32 && row < 32 ? 1.0 : -1.0, 1e-5) << row << "," << column;
    }
  }
}

// The same picture in any layout looks the same to the compact network.
TEST(MakeCondition, OrientationPlanesDoNotDependOnTheLayout) {
  const auto brightness = [](int x, int y) {  // 0 .. 1
    return 0.5 + 0.4 * std::sin(0.2 * x - 0.03 * y) * std::sin(0.11 * y);
  };
  const auto make = [&](PixelLayout layout) {
    const Frame frame = *AllocateFrame(layout, 800, 600);
    const double unit = static_cast<double>(1 << (layout.bit_depth - 8));
    const double most = static_cast<double>((1 << layout.bit_depth) - 1);
    const bool is_full = layout.is_rgb || layout.full_range;
    for (int p = 0; p < layout.num_planes; ++p) {
      FillPlane(frame, p, [&](int x, int y, int) {
        const double b = brightness(x, y);
        return layout.IsChroma(p)
                   ? static_cast<int>(128.0 * unit)
                   : static_cast<int>(std::lround(is_full ? b * most : (16.0 + 219.0 * b) * unit));
      });
    }
    return *MakeCondition(frame.View(), ConditionKind::kOrientationPlanes, kOrientationShape);
  };
  const Tensor expected = make(RgbaLayout());
  EXPECT_GT(*std::max_element(expected.values.begin(), expected.values.begin() + 32 * 384), 0.5F);
  PixelLayout full = Yuv420Layout();
  full.full_range = true;
  PixelLayout planar = Yuv420Layout(12);
  planar.is_rgb = true;
  for (const PixelLayout& layout :
       {Yuv420Layout(), Yuv420Layout(10), full, GrayLayout(16), planar}) {
    const Tensor planes = make(layout);
    double squares = 0.0;
    for (std::size_t i = 0; i < planes.values.size(); ++i) {
      squares += std::pow(planes.values[i] - expected.values[i], 2);
    }
    // Rounding to levels of different sizes.
    EXPECT_LT(std::sqrt(squares / static_cast<double>(planes.values.size())), 0.03);
  }
}

TEST(MakeCondition, TakesAnySizeAndAspect) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, std::pair{2, 3}, std::pair{3000, 1}, std::pair{1, 3000}, std::pair{31, 17},
        std::pair{63, 2000}, std::pair{4001, 47}}) {
    for (const PixelLayout& layout : {Yuv420Layout(), RgbaLayout(), GrayLayout(10)}) {
      const Frame frame = Flat(layout, width, height, {{{100, 100, 100, 100}, {128}, {128}}});
      const auto rgb = MakeCondition(frame.View(), ConditionKind::kRgb, kRgbShape);
      ASSERT_TRUE(rgb) << rgb.error().message;
      const auto planes =
          MakeCondition(frame.View(), ConditionKind::kOrientationPlanes, kOrientationShape);
      ASSERT_TRUE(planes) << planes.error().message;
      EXPECT_TRUE(std::all_of(planes->values.begin(), planes->values.end(),
                              [](float v) { return std::isfinite(v); }));
    }
  }
}

TEST(MakeCondition, RefusesWhatIsNoPicture) {
  const Frame frame = Flat(RgbaLayout(), 8, 8, {});
  FrameView nothing;
  EXPECT_FALSE(MakeCondition(nothing, ConditionKind::kRgb, kRgbShape));
  FrameView no_samples = frame.View();
  no_samples.planes[0].data = nullptr;
  EXPECT_FALSE(MakeCondition(no_samples, ConditionKind::kRgb, kRgbShape));
  FrameView short_plane = frame.View();
  short_plane.planes[0].height = 3;
  EXPECT_FALSE(MakeCondition(short_plane, ConditionKind::kRgb, kRgbShape));
  FrameView five_samples = frame.View();
  five_samples.layout.channels[0] = 5;
  EXPECT_FALSE(MakeCondition(five_samples, ConditionKind::kRgb, kRgbShape));
  EXPECT_FALSE(MakeCondition(frame.View(), ConditionKind::kRgb, {2, 64, 64}));
  EXPECT_FALSE(MakeCondition(frame.View(), ConditionKind::kRgb, {3, 0, 64}));
  EXPECT_FALSE(MakeCondition(frame.View(), ConditionKind::kOrientationPlanes, {73, 24, 17}));
}

}  // namespace
}  // namespace rsstab::rsdiff
