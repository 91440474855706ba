// SPDX-License-Identifier: Apache-2.0
#include "evaluation/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "igf/base/seeded_random.h"

namespace rsstab::evaluation {
namespace {

constexpr double kExact = 1e-12;

TEST(Statistics, OfAFewNumbers) {
  const std::vector<double> values = {4.0, 1.0, 3.0, 2.0};
  EXPECT_NEAR(Mean(values), 2.5, kExact);
  EXPECT_NEAR(StandardError(values), std::sqrt(5.0 / 3.0 / 4.0), kExact);
  EXPECT_NEAR(Quantile(values, 0.0), 1.0, kExact);
  EXPECT_NEAR(Quantile(values, 0.5), 2.5, kExact);
  EXPECT_NEAR(Quantile(values, 0.9), 3.7, kExact);
  EXPECT_NEAR(Quantile(values, 1.0), 4.0, kExact);
}

TEST(Statistics, OfNothingAreNotNumbers) {
  EXPECT_TRUE(std::isnan(Mean({})));
  EXPECT_TRUE(std::isnan(Quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(StandardError(std::vector<double>{1.0})));
  EXPECT_TRUE(std::isnan(BootstrapMean({}, {}, 1).low));
  const std::vector<double> constant = {2.0, 2.0};
  EXPECT_TRUE(std::isnan(FitLine(constant, constant).slope));
}

TEST(Statistics, LineIsFound) {
  const std::vector<double> x = {-1.0, 0.0, 1.0, 2.0};
  std::vector<double> y;
  for (const double v : x) {
    y.push_back(3.0 - 2.0 * v);
  }
  const LineFit line = FitLine(x, y);
  EXPECT_NEAR(line.slope, -2.0, kExact);
  EXPECT_NEAR(line.intercept, 3.0, kExact);
  EXPECT_NEAR(line.r_squared, 1.0, kExact);
  // An even function of x that a line explains nothing of.
  const LineFit flat =
      FitLine(std::vector<double>{-1.0, 0.0, 1.0}, std::vector<double>{1.0, 0.0, 1.0});
  EXPECT_NEAR(flat.slope, 0.0, kExact);
  EXPECT_NEAR(flat.r_squared, 0.0, kExact);
}

TEST(Statistics, BootstrapCoversTheMean) {
  constexpr int kTrials = 300;
  constexpr int kCount = 40;
  constexpr double kTruth = -0.7;
  SeededRandom random(5);
  int covered = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> values;
    std::vector<std::size_t> cluster;
    for (std::size_t i = 0; i < kCount; ++i) {
      values.push_back(kTruth + random.Normal());
      cluster.push_back(i);
    }
    const Interval interval = BootstrapMean(values, cluster, static_cast<std::uint64_t>(trial));
    covered += interval.low <= kTruth && kTruth <= interval.high ? 1 : 0;
  }
  // The percentile bootstrap of 40 values covers about 94%; 300 trials tell that to 1.4%.
  EXPECT_NEAR(static_cast<double>(covered) / kTrials, 0.94, 0.045);
}

TEST(Statistics, RepeatedMeasurementsOfAPhotoAreNoNewPhotos) {
  SeededRandom random(6);
  std::vector<double> once;
  std::vector<std::size_t> cluster_once;
  std::vector<double> four_times;
  std::vector<std::size_t> cluster_four;
  for (std::size_t photo = 0; photo < 30; ++photo) {
    const double value = random.Normal();
    once.push_back(value);
    cluster_once.push_back(photo);
    four_times.insert(four_times.end(), 4, value);
    cluster_four.insert(cluster_four.end(), 4, photo);
  }
  const Interval one = BootstrapMean(once, cluster_once, 7);
  const Interval four = BootstrapMean(four_times, cluster_four, 7);
  EXPECT_NEAR(one.low, four.low, kExact);
  EXPECT_NEAR(one.high, four.high, kExact);
  // About 2 x 1.96 / sqrt(30) wide.
  EXPECT_NEAR(one.high - one.low, 0.72, 0.2);
}

}  // namespace
}  // namespace rsstab::evaluation
