// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/noise_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rsstab::rsdiff {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

constexpr double kExact = 1e-12;  // double rounding over a thousand products

TEST(NoiseSchedule, LinearIsThePublishedOne) {
  const NoiseSchedule schedule = *NoiseSchedule::Create(ScheduleKind::kLinear, 1000);
  EXPECT_EQ(schedule.steps(), 1000);
  EXPECT_NEAR(schedule.Beta(0), 1e-4, kExact);
  EXPECT_NEAR(schedule.Beta(999), 0.02, kExact);
  EXPECT_NEAR(schedule.Beta(333), 1e-4 + 333.0 / 999.0 * 0.0199, kExact);
  EXPECT_NEAR(schedule.Signal(0), 1.0 - 1e-4, kExact);
  // Sum of the logarithms of 1 - beta.
  double logarithm = 0.0;
  for (int t = 0; t < 1000; ++t) {
    logarithm += std::log1p(-(1e-4 + t / 999.0 * 0.0199));
  }
  EXPECT_NEAR(schedule.Signal(999), std::exp(logarithm), kExact);
}

TEST(NoiseSchedule, LinearAddsAsMuchNoiseInFewerSteps) {
  const NoiseSchedule many = *NoiseSchedule::Create(ScheduleKind::kLinear, 1000);
  const NoiseSchedule few = *NoiseSchedule::Create(ScheduleKind::kLinear, 100);
  EXPECT_NEAR(few.Beta(0), 1e-3, kExact);
  EXPECT_NEAR(few.Beta(99), 0.2, kExact);
  // log(1 - beta) is -beta to first order, and the betas add up to the same.
  EXPECT_NEAR(std::log(few.Signal(99)) / std::log(many.Signal(999)), 1.0, 0.1);
}

TEST(NoiseSchedule, CosineFollowsItsClosedForm) {
  const int steps = 400;
  const NoiseSchedule schedule = *NoiseSchedule::Create(ScheduleKind::kCosine, steps);
  const auto f = [](double u) {
    const double c = std::cos((u + 0.008) / 1.008 * std::numbers::pi / 2.0);
    return c * c;
  };
  for (const int t : {0, 1, 57, 200, 398}) {
    EXPECT_NEAR(schedule.Signal(t), f((t + 1.0) / steps) / f(0.0), kExact) << t;
  }
  EXPECT_EQ(schedule.Beta(steps - 1), 0.999);  // the closed form would leave no signal at all
}

TEST(NoiseSchedule, SignalAlwaysFallsAndStaysPositive) {
  for (const ScheduleKind kind : {ScheduleKind::kLinear, ScheduleKind::kCosine}) {
    for (const int steps : {1, 2, 10, 1000}) {
      const NoiseSchedule schedule = *NoiseSchedule::Create(kind, steps);
      double before = 1.0;
      for (int t = 0; t < steps; ++t) {
        EXPECT_LT(schedule.Signal(t), before);
        EXPECT_GT(schedule.Signal(t), 0.0);
        before = schedule.Signal(t);
      }
    }
  }
}

TEST(NoiseSchedule, RefusesImpossibleSteps) {
  for (const int steps : {0, -1, 100001}) {
    const auto schedule = NoiseSchedule::Create(ScheduleKind::kLinear, steps);
    ASSERT_FALSE(schedule);
    EXPECT_EQ(schedule.error().code, ErrorCode::kInvalidArgument);
  }
}

// linspace(-1, 999, steps + 1), cut to integers, reversed.
TEST(DdimTimePairs, AreThePublishedOnes) {
  EXPECT_THAT(DdimTimePairs(1000, 1), ElementsAre(Pair(999, -1)));
  EXPECT_THAT(DdimTimePairs(1000, 2), ElementsAre(Pair(999, 499), Pair(499, -1)));
  EXPECT_THAT(DdimTimePairs(1000, 4),
              ElementsAre(Pair(999, 749), Pair(749, 499), Pair(499, 249), Pair(249, -1)));
  EXPECT_THAT(DdimTimePairs(1000, 8),
              ElementsAre(Pair(999, 874), Pair(874, 749), Pair(749, 624), Pair(624, 499),
                          Pair(499, 374), Pair(374, 249), Pair(249, 124), Pair(124, -1)));
  // 332.33 and 665.67 lose their fractions.
  EXPECT_THAT(DdimTimePairs(1000, 3), ElementsAre(Pair(999, 665), Pair(665, 332), Pair(332, -1)));
  EXPECT_THAT(DdimTimePairs(2, 2), ElementsAre(Pair(1, 0), Pair(0, -1)));
}

}  // namespace
}  // namespace rsstab::rsdiff
