// SPDX-License-Identifier: Apache-2.0
#include "evaluation/spread_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "igf/base/seeded_random.h"

namespace rsstab::evaluation {
namespace {

using rsdiff::RotationCurve;

constexpr int kBands = 24;

RotationCurve Draw(SeededRandom& random, double deviation) {
  RotationCurve curve;
  for (int band = 0; band < kBands; ++band) {
    curve.emplace_back(deviation * random.Normal(), deviation * random.Normal(),
                       deviation * random.Normal());
  }
  return curve;
}

double ShareOf(int samples, double truth_deviation, double sample_deviation) {
  SeededRandom random(static_cast<std::uint64_t>(samples));
  Coverage all;
  for (int trial = 0; trial < 200; ++trial) {
    const RotationCurve truth = Draw(random, truth_deviation);
    std::vector<RotationCurve> curves;
    for (int i = 0; i < samples; ++i) {
      curves.push_back(Draw(random, sample_deviation));
    }
    const AxisCoverage axes = CountCoverage(truth, curves).value();
    for (const Coverage& axis : axes) {
      EXPECT_EQ(axis.total, kBands - 4);
      all += axis;
    }
  }
  return all.Share();
}

TEST(SpreadCoverage, HonestSamplesCoverTheStatedShare) {
  // 12,000 values, the standard error of a share is 0.4%.
  for (const int samples : {9, 16, 40}) {
    EXPECT_NEAR(ShareOf(samples, 1.0, 1.0), 0.8, 0.015) << samples;
  }
}

TEST(SpreadCoverage, TooNarrowAndTooWideAreTold) {
  // Normal numbers inside +-1.2816 times half or twice their own deviation: 47.8% and 99%.
  EXPECT_NEAR(ShareOf(200, 1.0, 0.5), 0.478, 0.02);
  EXPECT_NEAR(ShareOf(200, 1.0, 2.0), 0.990, 0.01);
}

TEST(SpreadCoverage, KnownQuantiles) {
  // Samples 1 .. 19 in every place: the 10% and 90% quantiles are 2 and 18, ends included.
  std::vector<RotationCurve> samples;
  for (int i = 1; i <= 19; ++i) {
    samples.emplace_back(kBands, Eigen::Vector3d::Constant(i));
  }
  const auto share_at = [&](double truth, std::size_t axis) {
    return CountCoverage(RotationCurve(kBands, Eigen::Vector3d(truth, 10.0, -1.0)), samples)
        .value()[axis]
        .Share();
  };
  EXPECT_EQ(share_at(2.0, 0), 1.0);
  EXPECT_EQ(share_at(18.0, 0), 1.0);
  EXPECT_EQ(share_at(1.99, 0), 0.0);
  EXPECT_EQ(share_at(18.01, 0), 0.0);
  EXPECT_EQ(share_at(0.0, 1), 1.0);
  EXPECT_EQ(share_at(0.0, 2), 0.0);
}

TEST(SpreadCoverage, MiddleBandsDoNotCount) {
  RotationCurve truth(kBands, Eigen::Vector3d::Zero());
  for (std::size_t band = 10; band < 14; ++band) {
    truth[band].setConstant(100.0);
  }
  const std::vector<RotationCurve> samples(16, RotationCurve(kBands, Eigen::Vector3d::Zero()));
  EXPECT_EQ(CountCoverage(truth, samples).value()[0].Share(), 1.0);
  truth[9].setConstant(100.0);
  truth[14].setConstant(100.0);
  EXPECT_EQ(CountCoverage(truth, samples).value()[0].inside, 18);
}

TEST(SpreadCoverage, RefusesWhatItCannotJudge) {
  const RotationCurve truth(kBands, Eigen::Vector3d::Zero());
  EXPECT_FALSE(CountCoverage(truth, std::vector<RotationCurve>(8, truth)));
  EXPECT_FALSE(CountCoverage(
      truth, std::vector<RotationCurve>(16, RotationCurve(12, Eigen::Vector3d::Zero()))));
  const RotationCurve few(4, Eigen::Vector3d::Zero());
  EXPECT_FALSE(CountCoverage(few, std::vector<RotationCurve>(16, few)));
  EXPECT_TRUE(std::isnan(Coverage().Share()));
}

}  // namespace
}  // namespace rsstab::evaluation
