// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/dense_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "igf/base/rotation.h"
#include "rsdiff/rotation_curve.h"

namespace rsstab::rsdiff {
namespace {

constexpr Shape kPublished{2, 64, 64};

std::size_t Index(const Shape& shape, int channel, int row, int column) {
  return static_cast<std::size_t>((channel * shape.rows + row) * shape.columns + column);
}

// A network unit is columns - 1 small pixels, each W / columns big ones.
TEST(FieldFromDenseState, AConstantIsThatManyPixels) {
  std::vector<float> state(kPublished.Count(), 0.01F);
  std::fill(state.begin() + 64 * 64, state.end(), -0.02F);
  const MotionField field = *FieldFromDenseState(state, kPublished, 800, 600, 0.0, {5, 7});
  EXPECT_EQ(field.width(), 800);
  EXPECT_EQ(field.height(), 600);
  EXPECT_EQ(field.reference_row(), 0.0);
  for (const Eigen::Vector2f& g : field.vertices()) {
    EXPECT_NEAR(g.x(), 0.01 * 63.0 * 800.0 / 64.0, 1e-4);
    EXPECT_NEAR(g.y(), -0.02 * 63.0 * 600.0 / 64.0, 1e-4);
  }
}

// Small pixel i lies at (i + 0.5) W / 64 - 0.5 of the big picture, not at i (W - 1) / 63: a field
// that is linear in the big picture's pixels comes back exactly, edges included.
TEST(FieldFromDenseState, HasItsPixelCentresWhereTheShrunkPictureHasThem) {
  std::vector<float> state(kPublished.Count());
  const auto truth = [](double x, double y) {
    return Eigen::Vector2d(0.02 * (y - 299.5) + 0.001 * x, 0.004 * (y - 299.5) - 0.002 * x);
  };
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const Eigen::Vector2d g =
          truth((column + 0.5) * 800.0 / 64.0 - 0.5, (row + 0.5) * 600.0 / 64.0 - 0.5);
      state[Index(kPublished, 0, row, column)] = static_cast<float>(g.x() * 64.0 / 800.0 / 63.0);
      state[Index(kPublished, 1, row, column)] = static_cast<float>(g.y() * 64.0 / 600.0 / 63.0);
    }
  }
  const MotionField field = *FieldFromDenseState(state, kPublished, 800, 600, 299.5, {17, 65});
  for (int row = 0; row < 65; ++row) {
    for (int column = 0; column < 17; ++column) {
      const Eigen::Vector2d x = field.VertexPosition(column, row);
      EXPECT_LT((field.At(column, row).cast<double>() - truth(x.x(), x.y())).norm(), 1e-4);
    }
  }
}

TEST(DenseStateFromField, IsTheInverse) {
  const Camera camera = Camera::Pinhole(800, 600, 700.0);
  RotationCurve curve;
  for (int b = 0; b < 12; ++b) {
    curve.emplace_back(0.003 * b, 0.01 * std::sin(0.5 * b), -0.002 * b);
  }
  const MotionField field = *FieldFromCurve(curve, camera, {65, 257});
  const std::vector<float> state = DenseStateFromField(field, kPublished);
  const MotionField back = *FieldFromDenseState(state, kPublished, 800, 600, 299.5, {65, 257});
  for (int row = 0; row < 257; ++row) {
    for (int column = 0; column < 65; ++column) {
      // Straight lines between small pixels 9.4 rows apart, bends of 1e-3 px a row and row; more
      // where the field has a kink, since rows above the first count as the first.
      const bool has_kink = row < 12 || row > 244;
      EXPECT_LT((field.At(column, row) - back.At(column, row)).norm(), has_kink ? 0.5F : 0.02F)
          << column << "," << row;
    }
  }
}

// The same readout stated for the first row and for the middle one.
TEST(WithMiddleReference, IsWhatTheMiddleRowsCameraSees) {
  for (const auto& [width, height, focal_px] :
       {std::tuple{800, 600, 700.0}, std::tuple{480, 640, 500.0}}) {
    const Camera camera = Camera::Pinhole(width, height, focal_px);
    RotationCurve curve;
    for (int b = 0; b < 12; ++b) {
      curve.emplace_back(0.004 * b, 0.01 * std::sin(0.5 * b), -0.003 * b);
    }
    const int knots = ReadoutMotion::KnotCount(height);
    const auto from_middle = RowRotationsFromCurve(curve, camera, knots);
    std::vector<Eigen::Quaterniond> from_first;
    for (const Eigen::Quaterniond& rotation : from_middle) {
      from_first.push_back(rotation * from_middle.front().conjugate());
    }
    const FieldGrid grid{33, 129};
    MotionField first =
        *ComputeReadoutField(camera, *ReadoutMotion::Create(camera, from_first), grid);
    first.set_reference_row(0.0);
    const MotionField middle =
        *ComputeReadoutField(camera, *ReadoutMotion::Create(camera, from_middle), grid);
    EXPECT_GT((first.At(0, 64) - middle.At(0, 64)).norm(), 5.0F);
    const auto restated = WithMiddleReference(first, camera);
    ASSERT_TRUE(restated) << restated.error().message;
    EXPECT_EQ(restated->reference_row(), (height - 1) / 2.0);
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        const Eigen::Vector2d x = middle.VertexPosition(column, row);
        // The two pictures are shifted against each other by up to 25 px. So near the edges, rows
        // outside the frame count as the outermost ones: a kink that is only carried on.
        const bool is_inside =
            x.x() > 25.0 && x.x() < width - 26.0 && x.y() > 25.0 && x.y() < height - 26.0;
        // Inside, it is looked up between vertices 5 rows apart.
        EXPECT_LT((restated->At(column, row) - middle.At(column, row)).norm(),
                  is_inside ? 0.01F : 2.5F)
            << x.transpose();
      }
    }
  }
}

TEST(WithMiddleReference, LeavesAFieldThatHasItAlone) {
  const Camera camera = Camera::Pinhole(800, 600, 700.0);
  RotationCurve curve;
  for (int b = 0; b < 12; ++b) {
    curve.emplace_back(0.004 * b, 0.01 * std::sin(0.5 * b), -0.003 * b);
  }
  const MotionField field = *FieldFromCurve(curve, camera);
  const MotionField restated = *WithMiddleReference(field, camera);
  for (std::size_t v = 0; v < field.vertices().size(); ++v) {
    EXPECT_LT((restated.vertices()[v] - field.vertices()[v]).norm(), 1e-3F);
  }
}

TEST(DenseField, RefusesWhatMakesNoSense) {
  std::vector<float> state(kPublished.Count(), 0.0F);
  EXPECT_FALSE(FieldFromDenseState(std::span(state).first(7), kPublished, 800, 600, 0.0));
  EXPECT_FALSE(FieldFromDenseState(state, {1, 64, 128}, 800, 600, 0.0));
  EXPECT_FALSE(FieldFromDenseState(state, kPublished, 0, 600, 0.0));
  EXPECT_FALSE(FieldFromDenseState(state, kPublished, 800, 600, 0.0, {1, 2}));
  state[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(FieldFromDenseState(state, kPublished, 800, 600, 0.0));
  const MotionField field(800, 600, 5, 5);
  EXPECT_FALSE(WithMiddleReference(field, Camera::Pinhole(600, 800, 700.0)));
}

TEST(DenseField, WorksOnTheSmallestImages) {
  const std::vector<float> state(kPublished.Count(), 0.3F);
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{2, 1}, std::pair{1, 9}}) {
    const MotionField field = *FieldFromDenseState(state, kPublished, width, height, 0.0, {3, 3});
    const auto restated = WithMiddleReference(field, Camera::Pinhole(width, height, width));
    ASSERT_TRUE(restated);
    EXPECT_TRUE(std::isfinite(restated->MaxLength()));
  }
}

}  // namespace
}  // namespace rsstab::rsdiff
