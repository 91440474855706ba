// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/wobble.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 360;

// One match a 20x20 cell. The rows' common displacement is amplitude * sin(one turn over the
// height) along x; `noise` (standard deviation per axis) is each match's own.
std::vector<PointMatch> RowShear(double amplitude, double noise, unsigned seed,
                                 double scale = 1.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<PointMatch> matches;
  for (int y = 10; y < kHeight; y += 20) {
    for (int x = 10; x < kWidth; x += 20) {
      const double shift = amplitude * std::sin(2.0 * std::numbers::pi * y / kHeight);
      const Eigen::Vector2d from(x, y);
      const Eigen::Vector2d to =
          from + Eigen::Vector2d(shift + noise * normal(random), noise * normal(random));
      matches.push_back({(scale * from).cast<float>(), (scale * to).cast<float>()});
    }
  }
  return matches;
}

TEST(WobbleMeter, CommonPartOfRowsSurvivesNoiseThatCancels) {
  constexpr double kAmplitude = 0.4;
  constexpr double kNoise = 0.3;
  WobbleMeter meter(kWidth, kHeight);
  for (unsigned frame = 0; frame < 40; ++frame) {
    meter.Add(RowShear(kAmplitude, kNoise, frame), Eigen::Matrix3d::Identity());
  }
  const double common = kAmplitude / std::numbers::sqrt2;
  const double all = std::sqrt(common * common + 2.0 * kNoise * kNoise);
  // 23000 matches: 0.5% of statistical error at most.
  EXPECT_NEAR(meter.Wobble().value(), all, 0.01 * all);
  EXPECT_NEAR(meter.RowWobble().value(), common, 0.03 * common);
}

TEST(WobbleMeter, NoiseAloneIsHardlyAnyRowWobble) {
  WobbleMeter meter(kWidth, kHeight);
  for (unsigned frame = 0; frame < 40; ++frame) {
    meter.Add(RowShear(0.0, 0.1, frame), Eigen::Matrix3d::Identity());
  }
  EXPECT_NEAR(meter.Wobble().value(), 0.1 * std::numbers::sqrt2, 2e-3);
  // The product of two means of 16 scatters about 0 by 0.1^2 / 16 sqrt(2 / 18); the root of its
  // positive part stays below a tenth of the noise.
  EXPECT_LT(meter.RowWobble().value(), 0.015);
}

TEST(WobbleMeter, LeavesOutWhatTheHomographyExplainsAndGrossErrors) {
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift(0, 2) = 3.0;
  std::vector<PointMatch> matches = RowShear(0.0, 0.0, 1);
  for (PointMatch& match : matches) {
    match.to.x() += 3.0F;
  }
  matches[5].to.y() += 30.0F;  // lost track
  WobbleMeter meter(kWidth, kHeight);
  meter.Add(matches, shift);
  EXPECT_NEAR(meter.Wobble().value(), 0.0, 1e-4);  // float matches
}

TEST(WobbleMeter, IsStatedAt640PixelsWidth) {
  WobbleMeter meter(320, 180);
  meter.Add(RowShear(1.0, 0.0, 1, 0.5), Eigen::Matrix3d::Identity());
  EXPECT_NEAR(meter.Wobble().value(), 1.0 / std::numbers::sqrt2, 1e-3);
}

TEST(WobbleMeter, IsEmptyWithoutMatches) {
  WobbleMeter meter(kWidth, kHeight);
  EXPECT_FALSE(meter.Wobble());
  meter.Add({}, Eigen::Matrix3d::Identity());
  EXPECT_FALSE(meter.Wobble());
  EXPECT_FALSE(meter.RowWobble());
}

}  // namespace
}  // namespace rsstab::stabilizer
