// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/luma_proxy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace rsstab::stabilizer {
namespace {

// A horizontal ramp in the depth of `layout`; both depths show the same brightness.
Frame Ramp(const PixelLayout& layout, int width, int height) {
  Frame frame = *AllocateFrame(layout, width, height);
  const int channels = layout.channels[0];
  for (int y = 0; y < height; ++y) {
    std::uint8_t* row = frame.planes[0].data + y * frame.planes[0].stride;
    for (int x = 0; x < width; ++x) {
      const int level = 255 * x / width;
      for (int c = 0; c < channels; ++c) {
        const int index = x * channels + c;
        if (layout.bit_depth == 8) {
          row[index] = static_cast<std::uint8_t>(level);
        } else {
          const auto deep = static_cast<std::uint16_t>(level << (layout.bit_depth - 8));
          std::memcpy(row + 2 * index, &deep, 2);
        }
      }
    }
  }
  return frame;
}

TEST(LumaProxy, KeepsAspectAndNeverEnlarges) {
  EXPECT_EQ(ProxySizeFor(1920, 1080).width, 640);
  EXPECT_EQ(ProxySizeFor(1920, 1080).height, 360);
  EXPECT_EQ(ProxySizeFor(320, 240).width, 320);
  EXPECT_EQ(ProxySizeFor(8000, 2).height, 1);
}

TEST(LumaProxy, EveryDepthAndPackingShowsTheSameBrightness) {
  const auto reference = MakeLumaProxy(Ramp(GrayLayout(), 1280, 90).View());
  ASSERT_TRUE(reference);
  for (const PixelLayout& layout : {Yuv420Layout(8), Yuv420Layout(10), RgbaLayout()}) {
    const auto proxy = MakeLumaProxy(Ramp(layout, 1280, 90).View());
    ASSERT_TRUE(proxy);
    ASSERT_EQ(proxy->pixels.size(), reference->pixels.size());
    EXPECT_LE(FingerprintDistance(FingerprintOf(*proxy), FingerprintOf(*reference)), 1.0);
    EXPECT_NEAR(proxy->pixels[400], reference->pixels[400], 1);
  }
}

TEST(LumaProxy, FingerprintTellsPicturesApart) {
  const GrayImage ramp = *MakeLumaProxy(Ramp(GrayLayout(), 640, 360).View());
  GrayImage mirrored = ramp;
  for (int y = 0; y < ramp.height; ++y) {
    const auto begin = mirrored.pixels.begin() + static_cast<std::ptrdiff_t>(y) * ramp.width;
    std::reverse(begin, begin + ramp.width);
  }
  EXPECT_GT(FingerprintDistance(FingerprintOf(ramp), FingerprintOf(mirrored)), 50.0);
}

TEST(LumaProxy, OnePixelPicture) {
  const auto proxy = MakeLumaProxy(Ramp(GrayLayout(), 1, 1).View());
  ASSERT_TRUE(proxy);
  EXPECT_EQ(FingerprintOf(*proxy)[63], proxy->pixels[0]);
}

}  // namespace
}  // namespace rsstab::stabilizer
