// SPDX-License-Identifier: Apache-2.0
#include "igf/sample_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rsstab::igf {
namespace {

constexpr double kRate_hz = 400.0;

// Payloads of 1.001 s that hold whole packets of 7 samples, as a GoPro writes them.
std::vector<ClockMark> Marks(int count) {
  std::vector<ClockMark> marks;
  for (int i = 0; i < count; ++i) {
    const double start_s = 1.001 * i;
    marks.push_back({7.0 * std::floor(start_s * kRate_hz / 7.0), start_s});
  }
  return marks;
}

TEST(SampleClock, LineThroughExactMarks) {
  const auto clock = SampleClock::Fit(std::vector<ClockMark>{{0, 1.0}, {200, 1.5}, {400, 2.0}});
  ASSERT_TRUE(clock.has_value());
  EXPECT_NEAR(clock->TimeOf(0), 1.0, 1e-12);
  EXPECT_NEAR(clock->TimeOf(300), 1.75, 1e-12);
  EXPECT_NEAR(clock->TimeOf(-100), 0.75, 1e-12);
  EXPECT_NEAR(clock->TimeOf(1000), 3.5, 1e-12);
}

TEST(SampleClock, AveragesThePacketing) {
  const auto clock = SampleClock::Fit(Marks(60));
  ASSERT_TRUE(clock.has_value());
  const double interval_s = (clock->TimeOf(20000) - clock->TimeOf(0)) / 20000.0;
  EXPECT_NEAR(interval_s * kRate_hz, 1.0, 2e-4);  // one packet of 7 in 24000 samples
  // A packet holds up to 7 samples back, half of that on average.
  EXPECT_NEAR(clock->TimeOf(0), 3.5 / kRate_hz, 2.0 / kRate_hz);
}

TEST(SampleClock, OneFalseMarkDoesNotBendTheLine) {
  auto marks = Marks(13);
  const auto clean = SampleClock::Fit(std::span(marks).first(12));
  marks.back().time_s += 0.9;
  const auto clock = SampleClock::Fit(marks);
  ASSERT_TRUE(clean.has_value() && clock.has_value());
  EXPECT_NEAR(clock->TimeOf(4000), clean->TimeOf(4000), 1e-9);
  EXPECT_NEAR(clock->TimeOf(0), clean->TimeOf(0), 1e-9);
}

TEST(SampleClock, FollowsASlowDrift) {
  // The rate rises by 0.1 % over half an hour; one line would be off by 0.2 s in the middle.
  const auto sample_of = [](double t) { return kRate_hz * (t + 1e-3 * t * t / (2 * 1800.0)); };
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter_s(-0.009, 0.009);
  std::vector<ClockMark> marks;
  for (int i = 0; i < 1800; ++i) {
    marks.push_back({sample_of(1.001 * i), 1.001 * i + jitter_s(random)});
  }
  const auto clock = SampleClock::Fit(marks);
  ASSERT_TRUE(clock.has_value());
  for (double t = 0.0; t < 1800.0; t += 7.3) {
    // Jitter averaged over 121 marks, thrice that at the ends, and the curve within a window.
    EXPECT_NEAR(clock->TimeOf(sample_of(t)), t, 0.005);
  }
}

TEST(SampleClock, EvenAndShifted) {
  SampleClock clock = SampleClock::Even(2.0, 0.01);
  EXPECT_NEAR(clock.TimeOf(50), 2.5, 1e-12);
  clock.Shift(-0.5);
  EXPECT_NEAR(clock.TimeOf(50), 2.0, 1e-12);
}

TEST(SampleClock, RefusesMarksWithoutARate) {
  EXPECT_FALSE(SampleClock::Fit({}).has_value());
  EXPECT_FALSE(SampleClock::Fit(std::vector<ClockMark>{{0, 0.0}}).has_value());
  EXPECT_FALSE(SampleClock::Fit(std::vector<ClockMark>{{0, 0.0}, {0, 1.0}}).has_value());
  EXPECT_FALSE(SampleClock::Fit(std::vector<ClockMark>{{0, 5.0}, {1, 5.0}, {2, 5.0}}).has_value());
  EXPECT_FALSE(SampleClock::Fit(std::vector<ClockMark>{{0, 2.0}, {1, 1.0}}).has_value());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(SampleClock::Fit(std::vector<ClockMark>{{0, 0.0}, {1, nan}}).has_value());
}

}  // namespace
}  // namespace rsstab::igf
