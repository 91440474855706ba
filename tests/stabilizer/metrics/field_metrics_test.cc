// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/field_metrics.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr double kFloat = 1e-5;  // fields are stored in single precision

MotionField Constant(int width, int height, const Eigen::Vector2f& value) {
  MotionField field(width, height, 3, 5);
  for (Eigen::Vector2f& vertex : field.vertices()) {
    vertex = value;
  }
  return field;
}

TEST(EndPointError, OfDenseFieldsByHand) {
  const std::array<Eigen::Vector2f, 3> truth = {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 1),
                                                Eigen::Vector2f(-2, 5)};
  const std::array<Eigen::Vector2f, 3> estimate = {Eigen::Vector2f(3, 4), Eigen::Vector2f(1, 1),
                                                   Eigen::Vector2f(-2, 6)};
  EXPECT_NEAR(EndPointError(estimate, truth).value(), (5.0 + 0.0 + 1.0) / 3.0, kFloat);
  const std::array<std::uint8_t, 3> valid = {0, 1, 1};
  EXPECT_NEAR(EndPointError(estimate, truth, valid).value(), 0.5, kFloat);
}

TEST(EndPointError, OfMotionFieldsWithInvalidPixels) {
  const MotionField truth = Constant(8, 6, {1.0F, 0.0F});
  MotionField estimate = Constant(8, 6, {1.0F, 2.0F});
  EXPECT_NEAR(EndPointError(estimate, truth).value(), 2.0, kFloat);
  // Wrong in the last column of vertices only: rises linearly over the right half, 0 to the left.
  estimate = truth;
  for (int row = 0; row < 5; ++row) {
    estimate.At(2, row) = {8.0F, 0.0F};
  }
  std::vector<std::uint8_t> valid(8 * 6, 0);
  for (std::size_t y = 0; y < 6; ++y) {
    valid[y * 8 + 7] = 1;
  }
  EXPECT_NEAR(EndPointError(estimate, truth, valid).value(), 7.0, kFloat);
}

TEST(EndPointError, RescalesTheEstimate) {
  // 2 px of 101 (corner to corner 100) are 4 px of 201.
  EXPECT_NEAR(
      EndPointError(Constant(101, 51, {2.0F, 0.0F}), Constant(201, 101, {0.0F, 0.0F})).value(), 4.0,
      kFloat);
}

TEST(EndPointError, RefusesWhatCannotBeCompared) {
  const MotionField field = Constant(8, 6, {0.0F, 0.0F});
  MotionField first_row = field;
  first_row.set_reference_row(0.0);
  EXPECT_FALSE(EndPointError(first_row, field));
  const std::vector<std::uint8_t> none(8 * 6, 0);
  EXPECT_FALSE(EndPointError(field, field, none));
  EXPECT_FALSE(EndPointError(field, field, std::vector<std::uint8_t>(3, 1)));
  EXPECT_FALSE(EndPointError(MotionField(), field));
  const std::vector<Eigen::Vector2f> two(2, Eigen::Vector2f::Zero());
  const std::vector<Eigen::Vector2f> three(3, Eigen::Vector2f::Zero());
  EXPECT_FALSE(EndPointError(two, three));
}

}  // namespace
}  // namespace rsstab::stabilizer
