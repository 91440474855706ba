// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/image_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 16;
constexpr std::size_t kPixels = static_cast<std::size_t>(kWidth) * kHeight;
constexpr double kExact = 1e-9;

Frame Filled(int value, int bit_depth = 8, int height = kHeight) {
  Frame frame = AllocateFrame(GrayLayout(bit_depth), kWidth, height).value();
  for (int y = 0; y < height; ++y) {
    std::uint8_t* row = frame.planes[0].data + y * frame.planes[0].stride;
    for (int x = 0; x < kWidth; ++x) {
      if (bit_depth == 8) {
        row[x] = static_cast<std::uint8_t>(value);
      } else {
        reinterpret_cast<std::uint16_t*>(row)[x] = static_cast<std::uint16_t>(value);
      }
    }
  }
  return frame;
}

void Set(Frame& frame, int x, int y, int value) {
  frame.planes[0].data[y * frame.planes[0].stride + x] = static_cast<std::uint8_t>(value);
}

TEST(Psnr, OfAConstantDifference) {
  const Frame a = Filled(100);
  const Frame b = Filled(105);
  EXPECT_NEAR(Psnr(a.View(), b.View()).value(), 20.0 * std::log10(255.0 / 5.0), kExact);
  const Frame deep_a = Filled(400, 10);
  const Frame deep_b = Filled(404, 10);
  EXPECT_NEAR(Psnr(deep_a.View(), deep_b.View()).value(), 20.0 * std::log10(1023.0 / 4.0), kExact);
}

TEST(Psnr, OfOneWrongPixelAndWithoutIt) {
  const Frame a = Filled(50);
  Frame b = Filled(50);
  Set(b, 3, 4, 70);
  const double mean_square = 20.0 * 20.0 / static_cast<double>(kPixels);
  EXPECT_NEAR(Psnr(a.View(), b.View()).value(), 10.0 * std::log10(255.0 * 255.0 / mean_square),
              kExact);
  std::vector<std::uint8_t> valid(kPixels, 1);
  valid[4 * kWidth + 3] = 0;
  EXPECT_EQ(Psnr(a.View(), b.View(), valid).value(), kLargestPsnrDb);
}

TEST(Psnr, OfPackedColourIsThatOfTheMean) {
  Frame a = AllocateFrame(RgbaLayout(), 4, 4).value();
  Frame b = AllocateFrame(RgbaLayout(), 4, 4).value();
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 16; ++x) {
      a.planes[0].data[y * a.planes[0].stride + x] = 90;
      // Red brighter by 9: the mean by 3. Alpha does not count.
      const bool red = x % 4 == 0;
      const bool alpha = x % 4 == 3;
      b.planes[0].data[y * b.planes[0].stride + x] =
          static_cast<std::uint8_t>(red ? 99 : (alpha ? 7 : 90));
    }
  }
  EXPECT_NEAR(Psnr(a.View(), b.View()).value(), 20.0 * std::log10(255.0 / 3.0), kExact);
}

TEST(Ssim, OfTwoFlatPictures) {
  const Frame a = Filled(100);
  const Frame b = Filled(120);
  // Variances and covariance are 0, so only the luminance term is left.
  const double c1 = 0.01 * 255.0 * 0.01 * 255.0;
  const double expected = (2.0 * 100.0 * 120.0 + c1) / (100.0 * 100.0 + 120.0 * 120.0 + c1);
  EXPECT_NEAR(Ssim(a.View(), b.View()).value(), expected, 1e-6);
  EXPECT_NEAR(Ssim(a.View(), a.View()).value(), 1.0, kExact);
}

TEST(Ssim, OfPatternAndItsNegativeIsNegative) {
  Frame a = Filled(128);
  Frame b = Filled(128);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int sign = (x + y) % 2 == 0 ? 1 : -1;
      Set(a, x, y, 128 + 60 * sign);
      Set(b, x, y, 128 - 60 * sign);
    }
  }
  EXPECT_LT(Ssim(a.View(), b.View()).value(), -0.9);
}

TEST(Ssim, InvalidPixelsTouchNoWindow) {
  Frame a = Filled(80);
  Frame b = Filled(80);
  std::vector<std::uint8_t> valid(kPixels, 1);
  for (int y = 0; y < kHeight; ++y) {
    Set(b, 0, y, 0);  // a black edge
    valid[static_cast<std::size_t>(y) * kWidth] = 0;
  }
  EXPECT_LT(Ssim(a.View(), b.View()).value(), 0.9);
  EXPECT_NEAR(Ssim(a.View(), b.View(), valid).value(), 1.0, kExact);
}

TEST(ImageMetrics, RefuseWhatCannotBeCompared) {
  const Frame a = Filled(1);
  const std::vector<std::uint8_t> none(kPixels, 0);
  const std::vector<std::uint8_t> short_mask(kPixels - 1, 1);
  const Frame taller = Filled(1, 8, kHeight + 1);
  const Frame deeper = Filled(1, 10);
  for (const auto& metric : {Psnr, Ssim}) {
    EXPECT_EQ(metric(a.View(), taller.View(), {}).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(metric(a.View(), deeper.View(), {}).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(metric(a.View(), a.View(), none).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(metric(a.View(), a.View(), short_mask).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(metric(FrameView{}, FrameView{}, {}).error().code, ErrorCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace rsstab::stabilizer
