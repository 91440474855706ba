// SPDX-License-Identifier: Apache-2.0
#include "cli/images/flow_colors.h"

#include <gtest/gtest.h>

#include <array>

namespace rsstab::images {
namespace {

using Rgb = std::array<int, 3>;

// Colour at the right edge of a field that grows from nothing at the left to `displacement`.
std::array<Rgb, 2> Ends(const Eigen::Vector2f& displacement) {
  MotionField field(9, 4, 2, 2);
  field.At(1, 0) = displacement;
  field.At(1, 1) = displacement;
  WorkerPool workers(1);
  const auto picture = FlowColors(field, workers);
  EXPECT_TRUE(picture);
  const auto pixel = [&](int x) {
    const std::uint8_t* rgb = picture->planes[0].data + 3 * x;
    return Rgb{rgb[0], rgb[1], rgb[2]};
  };
  return {pixel(0), pixel(8)};
}

TEST(FlowColors, HueTellsTheDirection) {
  EXPECT_EQ(Ends({5, 0})[1], (Rgb{255, 0, 0}));       // right: red
  EXPECT_EQ(Ends({0, 0.1F})[1], (Rgb{255, 234, 0}));  // down: yellow
  const Rgb left = Ends({-2, 0})[1];                  // cyan
  EXPECT_EQ(left[0], 0);
  EXPECT_GT(std::min(left[1], left[2]), 190);
  const Rgb up = Ends({0, -3})[1];  // blue to purple
  EXPECT_EQ(up[2], 255);
  EXPECT_EQ(up[1], 0);
}

TEST(FlowColors, NoMotionIsWhite) {
  EXPECT_EQ(Ends({5, 0})[0], (Rgb{255, 255, 255}));
  EXPECT_EQ(Ends({0, 0})[1], (Rgb{255, 255, 255}));
}

TEST(FlowColors, ScaleMayBeGiven) {
  MotionField field(9, 4, 2, 2);
  for (auto& vertex : field.vertices()) {
    vertex = {2, 0};
  }
  WorkerPool workers(1);
  const auto picture = FlowColors(field, workers, 4.0);
  ASSERT_TRUE(picture);
  const std::uint8_t* rgb = picture->planes[0].data;
  EXPECT_EQ((Rgb{rgb[0], rgb[1], rgb[2]}), (Rgb{255, 128, 128}));  // half as red
}

TEST(FlowColors, WheelHasNoSeam) {
  const Rgb above = Ends({1, -1e-3F})[1];
  const Rgb below = Ends({1, 1e-3F})[1];
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(above[c], below[c], 2);
  }
}

}  // namespace
}  // namespace rsstab::images
