// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/orientation_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "igf/base/whole_file.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

constexpr int kCells = 24 * 16;

// As picture() in data/make_orientation_golden.py.
std::vector<std::uint8_t> ProceduralPicture(int width, int height) {
  const auto floor_div = [](int a, int b) {
    return static_cast<int>(std::floor(static_cast<double>(a) / b));
  };
  std::vector<std::uint8_t> picture;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int board = std::abs(floor_div(3 * x + y, 47) + floor_div(2 * y - x, 31)) % 2 * 120;
      const int wave = std::abs((5 * x + 7 * y) % 96 - 48);
      const int dither = (x * 7919 + y * 104729 + x * y) % 11;
      picture.push_back(static_cast<std::uint8_t>(x + y < 120 ? 90 : board + wave + dither + 20));
    }
  }
  return picture;
}

// Made by data/make_orientation_golden.py.
TEST(OrientationPlanes, EqualsTheTrainingCode) {
  constexpr std::size_t kStride = 19;
  const auto bytes = ReadWholeFile(
      rsstab::testing::SourceFile("tests/rsdiff/data/orientation_golden.bin").string(), 1U << 20U);
  ASSERT_TRUE(bytes) << bytes.error().message;
  std::vector<float> golden(bytes->size() / sizeof(float));
  std::memcpy(golden.data(), bytes->data(), bytes->size());
  const Tensor planes = *OrientationPlanes(ProceduralPicture(392, 282), {392, 282});
  ASSERT_EQ(planes.shape, kOrientationShape);
  ASSERT_EQ(golden.size(), (planes.values.size() + kStride - 1) / kStride);
  int different = 0;
  for (std::size_t i = 0; i < golden.size(); ++i) {
    const double difference = std::abs(planes.values[i * kStride] - golden[i]);
    // A strength on the border of two steps may fall to either side (1/32); then it moves shares of
    // its cell a little too.
    EXPECT_LE(difference, 1.0 / 32.0 + 1e-6) << i * kStride;
    different += difference > 1e-5 ? 1 : 0;
  }
  EXPECT_LE(different, static_cast<int>(golden.size()) / 100);
}

// A picture of stripes that lean: x + slope * y = const.
std::vector<std::uint8_t> Stripes(int width, int height, double slope, bool upright) {
  std::vector<std::uint8_t> picture;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double across = upright ? x - slope * y : y - slope * x;
      picture.push_back(static_cast<std::uint8_t>(128.0 + 90.0 * std::sin(0.35 * across)));
    }
  }
  return picture;
}

// Mean bin of one family, weighted by share.
double MeanBin(const Tensor& planes, int first, int bins) {
  double sum = 0.0;
  double weighted = 0.0;
  for (int bin = 0; bin < bins; ++bin) {
    for (int cell = 0; cell < kCells; ++cell) {
      const auto share = static_cast<double>(
          planes.values[static_cast<std::size_t>((32 + first + bin) * kCells + cell)]);
      sum += share * share;
      weighted += share * share * bin;
    }
  }
  return weighted / sum;
}

double Strength(const Tensor& planes, int first, int bins) {
  double sum = 0.0;
  for (int i = first * kCells; i < (first + bins) * kCells; ++i) {
    sum += static_cast<double>(planes.values[static_cast<std::size_t>(i)]);
  }
  return sum;
}

TEST(OrientationPlanes, SortsEdgesByTheirLean) {
  double before = 0.0;
  for (const double slope : {-0.2, -0.05, 0.0, 0.05, 0.2}) {
    const Tensor planes = *OrientationPlanes(Stripes(384, 288, slope, true), {384, 288});
    EXPECT_GT(Strength(planes, 0, 20), 100.0 * (Strength(planes, 20, 12) + 1.0));
    const double bin = MeanBin(planes, 0, 20);
    // asinh(slope / 0.15), scaled so that +-1 are the outermost of 20 bins.
    EXPECT_NEAR(bin, 9.5 + 9.5 * std::asinh(slope / 0.15) / std::asinh(1.0 / 0.15), 0.25) << slope;
    EXPECT_GT(bin, before);
    before = bin;
  }
  const Tensor level = *OrientationPlanes(Stripes(384, 288, 0.1, false), {384, 288});
  EXPECT_GT(Strength(level, 20, 12), 100.0 * (Strength(level, 0, 20) + 1.0));
  EXPECT_NEAR(MeanBin(level, 20, 12), 5.5 + 5.5 * std::asinh(0.1 / 0.15) / std::asinh(1.0 / 0.15),
              0.25);
}

TEST(OrientationPlanes, AFlatPictureHasNone) {
  const Tensor planes = *OrientationPlanes(std::vector<std::uint8_t>(64 * 48, 77), {64, 48});
  for (std::size_t i = 0; i < 72 * kCells; ++i) {
    EXPECT_EQ(planes.values[i], 0.0F);
  }
  // x of the cells in image heights.
  EXPECT_NEAR(planes.values[72 * kCells], 64.0 / 48.0 * (0.5 / 16.0 - 0.5), 1e-6);
  EXPECT_NEAR(planes.values[73 * kCells - 1], 64.0 / 48.0 * (15.5 / 16.0 - 0.5), 1e-6);
}

TEST(OrientationWorkingSize, KeepsAreaAndAspect) {
  const auto is = [](PictureSize size, int width, int height) {
    return size.width == width && size.height == height;
  };
  EXPECT_TRUE(is(OrientationWorkingSize(384, 288), 384, 288));
  EXPECT_TRUE(is(OrientationWorkingSize(800, 600), 384, 288));
  EXPECT_TRUE(is(OrientationWorkingSize(1920, 1080), 443, 249));
  EXPECT_TRUE(is(OrientationWorkingSize(1080, 1920), 249, 443));
  EXPECT_TRUE(is(OrientationWorkingSize(1, 1), 333, 333));
  EXPECT_EQ(OrientationWorkingSize(65535, 1).height, 48);
  EXPECT_EQ(OrientationWorkingSize(1, 65535).width, 64);
}

TEST(OrientationPlanes, RefusesOtherSizes) {
  const std::vector<std::uint8_t> picture(64 * 48);
  EXPECT_FALSE(OrientationPlanes(picture, {63, 48}));
  EXPECT_FALSE(OrientationPlanes(picture, {48, 64}));
  EXPECT_FALSE(OrientationPlanes(picture, {64, 49}));
}

}  // namespace
}  // namespace rsstab::rsdiff
