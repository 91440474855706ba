// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/host_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rsstab::frei0r {
namespace {

// What FFmpeg makes of a frame without a time: AV_NOPTS_VALUE * time base (* 1000).
double NoTime(double time_base, double scale) {
  return static_cast<double>(std::numeric_limits<std::int64_t>::min()) * time_base * scale;
}

TEST(HostClock, MillisecondsBecomeSeconds) {
  HostClock clock(TimeUnit::kMilliseconds);
  EXPECT_DOUBLE_EQ(clock.Seconds(33.366666666666667).value(), 1001.0 / 30000.0);
}

TEST(HostClock, SecondsStay) {
  HostClock clock(TimeUnit::kSeconds);
  EXPECT_EQ(clock.Seconds(0.0), 0.0);
  EXPECT_EQ(clock.Seconds(3600.5), 3600.5);
  EXPECT_EQ(clock.Seconds(3605.5), 3605.5);  // somebody drags the play head
  EXPECT_EQ(clock.Seconds(3612.5), 3612.5);
  EXPECT_EQ(clock.Seconds(-0.04), -0.04);
}

TEST(HostClock, FindsMillisecondsByTheirSteps) {
  HostClock clock(TimeUnit::kUnknown);
  EXPECT_EQ(clock.Seconds(0.0), 0.0);
  EXPECT_EQ(clock.Seconds(40.0), 40.0);  // may be a gap in a clip
  EXPECT_DOUBLE_EQ(clock.Seconds(80.0).value(), 0.08);
  EXPECT_DOUBLE_EQ(clock.Seconds(120.0).value(), 0.12);
}

TEST(HostClock, KeepsSecondsWhenAClipHasAGap) {
  HostClock clock(TimeUnit::kUnknown);
  for (const double time : {0.0, 0.04, 7.0, 7.04, 9.5, 9.54}) {
    EXPECT_EQ(clock.Seconds(time), time);
  }
}

TEST(HostClock, NoTimeIsNoTime) {
  for (const double time_base : {1.0, 1.0 / 30, 1.0 / 90000, 1e-6, 1e-9}) {
    HostClock milliseconds(TimeUnit::kMilliseconds);
    EXPECT_FALSE(milliseconds.Seconds(NoTime(time_base, 1000.0))) << time_base;
    HostClock seconds(TimeUnit::kSeconds);
    EXPECT_FALSE(seconds.Seconds(NoTime(time_base, 1.0))) << time_base;
  }
  HostClock clock(TimeUnit::kSeconds);
  EXPECT_FALSE(clock.Seconds(std::nan("")));
}

}  // namespace
}  // namespace rsstab::frei0r
