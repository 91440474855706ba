// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace rsstab::igf {
namespace {

using ::testing::HasSubstr;

constexpr double kInterval_s = 0.005;

std::vector<GyroSample> Regular(int count, double start_s = 0.0) {
  std::vector<GyroSample> samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back({start_s + i * kInterval_s, {0.1, -0.2, 0.3}});
  }
  return samples;
}

void ExpectRefused(std::vector<GyroSample> samples, const std::string& words) {
  const auto log = GyroLog::Create(std::move(samples));
  ASSERT_FALSE(log.has_value());
  EXPECT_EQ(log.error().code, ErrorCode::kCorruptData);
  EXPECT_THAT(log.error().message, HasSubstr(words));
}

TEST(GyroLog, TellsItsSpanAndRate) {
  const auto log = GyroLog::Create(Regular(201, -3.0));
  ASSERT_TRUE(log.has_value()) << log.error().message;
  EXPECT_EQ(log->samples().size(), 201U);
  EXPECT_DOUBLE_EQ(log->start_s(), -3.0);
  EXPECT_DOUBLE_EQ(log->end_s(), -3.0 + 200 * kInterval_s);
  EXPECT_NEAR(log->mean_rate_hz(), 200.0, 1e-9);
  EXPECT_TRUE(log->gaps().empty());
}

TEST(GyroLog, RefusesNumbersThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    auto samples = Regular(50);
    samples[17].rate_rad_s.z() = bad;
    ExpectRefused(samples, "gyro sample 17");
    samples = Regular(50);
    samples[18].time_s = bad;
    ExpectRefused(samples, "gyro sample 18");
  }
}

TEST(GyroLog, RefusesTimeThatRepeatsOrRunsBackwards) {
  auto samples = Regular(50);
  samples[20].time_s = samples[19].time_s;
  ExpectRefused(samples, "gyro sample 20: time repeats");
  samples = Regular(50);
  std::swap(samples[30], samples[31]);
  ExpectRefused(samples, "gyro sample 31: time runs backwards");
}

TEST(GyroLog, RefusesTooFewSamples) {
  ExpectRefused({}, "has 0 samples");
  ExpectRefused(Regular(1), "has 1 samples");
  EXPECT_TRUE(GyroLog::Create(Regular(2)).has_value());
}

TEST(GyroLog, RefusesDegreesPerSecondAndMilliseconds) {
  auto samples = Regular(50);
  samples[3].rate_rad_s.x() = -360.0;
  ExpectRefused(samples, "degrees per second");
  samples = Regular(50);
  for (GyroSample& sample : samples) {
    sample.time_s *= 1000.0;
  }
  ExpectRefused(samples, "in seconds?");
  for (GyroSample& sample : samples) {
    sample.time_s *= 1e-9;
  }
  ExpectRefused(samples, "in seconds?");
}

TEST(GyroLog, ListsAGapAndStaysUsableAroundIt) {
  auto samples = Regular(400);
  const double gap_begin_s = samples[99].time_s;
  for (std::size_t i = 100; i < samples.size(); ++i) {
    samples[i].time_s += 0.2;
  }
  const auto log = GyroLog::Create(samples);
  ASSERT_TRUE(log.has_value()) << log.error().message;
  ASSERT_EQ(log->gaps().size(), 1U);
  EXPECT_DOUBLE_EQ(log->gaps()[0].begin_s, gap_begin_s);
  EXPECT_DOUBLE_EQ(log->gaps()[0].end_s, samples[100].time_s);
  EXPECT_NEAR(log->mean_rate_hz(), 200.0, 1e-9);

  EXPECT_TRUE(log->Covers(log->start_s(), gap_begin_s));
  EXPECT_TRUE(log->Covers(samples[100].time_s, log->end_s()));
  EXPECT_FALSE(log->Covers(gap_begin_s - 0.01, gap_begin_s + 0.01));
  EXPECT_FALSE(log->Covers(gap_begin_s + 0.05, gap_begin_s + 0.06));
  EXPECT_FALSE(log->Covers(gap_begin_s - 0.01, samples[100].time_s + 0.01));
  EXPECT_FALSE(log->Covers(log->start_s() - 1e-6, 0.1));
  EXPECT_FALSE(log->Covers(0.1, log->end_s() + 1e-6));
}

TEST(GyroLog, AMissingSampleIsNoGap) {
  auto samples = Regular(100);
  samples.erase(samples.begin() + 40, samples.begin() + 43);
  const auto log = GyroLog::Create(samples);
  ASSERT_TRUE(log.has_value());
  EXPECT_TRUE(log->gaps().empty());
}

TEST(GyroLog, RefusesALogThatIsMostlyGap) {
  auto samples = Regular(100);
  for (std::size_t i = 50; i < samples.size(); ++i) {
    samples[i].time_s += 2.0;
  }
  ExpectRefused(samples, "the longest 2.005 s at 0.245 s");
}

TEST(GyroLog, RefusesOptionsThatMakeNoSense) {
  GyroLogOptions options;
  options.gap_intervals = 0.5;
  const auto log = GyroLog::Create(Regular(10), options);
  ASSERT_FALSE(log.has_value());
  EXPECT_EQ(log.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace rsstab::igf
