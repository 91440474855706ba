// SPDX-License-Identifier: Apache-2.0
#include "igf/base/motion_field.h"

#include <gtest/gtest.h>

namespace rsstab {
namespace {

TEST(MotionField, CornersOfTheGridLieOnCornerPixels) {
  const MotionField field(640, 360, 9, 33);
  EXPECT_EQ(field.VertexPosition(0, 0), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(field.VertexPosition(8, 32), Eigen::Vector2d(639.0, 359.0));
  EXPECT_EQ(field.reference_row(), 179.5);
}

TEST(MotionField, BilinearReproducesLinearMotionAndClampsOutside) {
  MotionField field(101, 51, 5, 6);
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 5; ++c) {
      const Eigen::Vector2d p = field.VertexPosition(c, r);
      field.At(c, r) = Eigen::Vector2d(0.1 * p.x() - 2.0, 0.3 * p.y()).cast<float>();
    }
  }
  const Eigen::Vector2d inside = field.Sample({33.3, 44.4});
  EXPECT_NEAR(inside.x(), 1.33, 1e-5);
  EXPECT_NEAR(inside.y(), 13.32, 1e-5);
  EXPECT_NEAR(field.Sample({-10.0, 60.0}).y(), 15.0, 1e-5);
}

TEST(MotionField, SizeChangeScalesEachAxis) {
  MotionField field(101, 51, 2, 2);
  for (auto& d : field.vertices()) {
    d = {1.0F, 1.0F};
  }
  const MotionField twice = field.Rescaled(201, 151);
  EXPECT_FLOAT_EQ(twice.At(1, 1).x(), 2.0F);
  EXPECT_FLOAT_EQ(twice.At(1, 1).y(), 3.0F);
  EXPECT_DOUBLE_EQ(twice.reference_row(), 75.0);
}

TEST(MotionField, OnePixelImageIsHarmless) {
  const MotionField field(1, 1, 2, 2);
  EXPECT_EQ(field.Sample({0.0, 0.0}), Eigen::Vector2d(0.0, 0.0));
}

}  // namespace
}  // namespace rsstab
