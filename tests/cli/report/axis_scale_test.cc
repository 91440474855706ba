// SPDX-License-Identifier: Apache-2.0
#include "cli/report/axis_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rsstab::report {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

constexpr double kRounding = 1e-12;  // a few units in the last place of the steps below

TEST(AxisScale, EndsOnTicksWhereAsked) {
  const AxisScale scale = MakeAxisScale(-0.031, 0.117, 5, true);
  EXPECT_NEAR(scale.step, 0.05, kRounding);
  EXPECT_NEAR(scale.low, -0.05, kRounding);
  EXPECT_NEAR(scale.high, 0.15, kRounding);
  EXPECT_THAT(scale.Ticks(),
              Pointwise(DoubleNear(kRounding), std::vector<double>{-0.05, 0.0, 0.05, 0.1, 0.15}));
  EXPECT_EQ(scale.Label(scale.Ticks()[0]), "\u22120.05");
  EXPECT_EQ(scale.Label(scale.Ticks()[1]), "0");
  EXPECT_EQ(scale.Label(scale.Ticks()[3]), "0.10");
}

TEST(AxisScale, SpansTheValuesExactlyElsewhere) {
  const AxisScale scale = MakeAxisScale(0.4, 9.7, 5, false);
  EXPECT_EQ(scale.low, 0.4);
  EXPECT_EQ(scale.high, 9.7);
  EXPECT_EQ(scale.step, 5.0);
  EXPECT_THAT(scale.Ticks(), Pointwise(DoubleNear(kRounding), std::vector<double>{5.0}));
  EXPECT_DOUBLE_EQ(scale.Place(0.4), 0.0);
  EXPECT_DOUBLE_EQ(scale.Place(9.7), 1.0);
}

TEST(AxisScale, LabelsLargeStepsWithoutDecimals) {
  const AxisScale scale = MakeAxisScale(0, 4321, 5, true);
  EXPECT_EQ(scale.step, 2000.0);
  EXPECT_EQ(scale.Label(4000), "4000");
}

TEST(AxisScale, GivesRoomToEqualValuesAndNothing) {
  const AxisScale constant = MakeAxisScale(25.0, 25.0, 5, true);
  EXPECT_LT(constant.low, 25.0);
  EXPECT_GT(constant.high, 25.0);
  const AxisScale zero = MakeAxisScale(0.0, 0.0, 5, true);
  EXPECT_LT(zero.low, zero.high);
  const double infinity = std::numeric_limits<double>::infinity();
  const AxisScale none = MakeAxisScale(infinity, -infinity, 5, true);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_EQ(none.high, 1.0);
}

TEST(AxisScale, NumberOfTicksStaysNearWhatIsWanted) {
  for (double span = 1e-7; span < 1e9; span *= 1.7) {
    const auto ticks = MakeAxisScale(-0.3 * span, 0.7 * span, 6, true).Ticks();
    EXPECT_GE(ticks.size(), 3U) << span;
    EXPECT_LE(ticks.size(), 8U) << span;
  }
}

}  // namespace
}  // namespace rsstab::report
