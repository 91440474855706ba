// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/resample_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr int kOne = 1 << kWeightBits;
constexpr std::array kAllInterpolations = {Interpolation::kBilinear, Interpolation::kBicubic,
                                           Interpolation::kLanczos};

std::vector<int> WeightsOf(const FilterBank& filter, unsigned phase) {
  const std::int16_t* weights = filter.Weights(phase);
  return {weights, weights + filter.taps()};
}

TEST(FilterBank, WeightsSumToOneAtEveryPhase) {
  for (const Interpolation interpolation : kAllInterpolations) {
    const FilterBank filter(interpolation);
    for (unsigned phase = 0; phase < kPhases; ++phase) {
      const std::vector<int> weights = WeightsOf(filter, phase);
      EXPECT_EQ(std::accumulate(weights.begin(), weights.end(), 0), kOne);
    }
  }
}

TEST(FilterBank, PhaseZeroCopies) {
  for (const Interpolation interpolation : kAllInterpolations) {
    const FilterBank filter(interpolation);
    std::vector<int> expected(static_cast<std::size_t>(filter.taps()), 0);
    expected[expected.size() / 2 - 1] = kOne;
    EXPECT_EQ(WeightsOf(filter, 0), expected);
  }
}

TEST(FilterBank, IsSymmetric) {
  // Lanczos' rounding remainder goes to one of the weights.
  constexpr int kRounding = 3;
  for (const Interpolation interpolation : kAllInterpolations) {
    const FilterBank filter(interpolation);
    for (unsigned phase = 1; phase < kPhases; ++phase) {
      const std::vector<int> weights = WeightsOf(filter, phase);
      std::vector<int> mirrored = WeightsOf(filter, kPhases - phase);
      std::reverse(mirrored.begin(), mirrored.end());
      for (std::size_t k = 0; k < weights.size(); ++k) {
        EXPECT_NEAR(weights[k], mirrored[k], kRounding) << phase;
      }
    }
  }
}

// Sum of weights times the k-th power of the distance between tap and position.
double Moment(const FilterBank& filter, unsigned phase, int power) {
  const std::vector<int> weights = WeightsOf(filter, phase);
  double moment = 0.0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double tap = static_cast<double>(k) - (filter.taps() / 2 - 1);
    moment += weights[k] * std::pow(tap - phase / static_cast<double>(kPhases), power);
  }
  return moment / kOne;
}

TEST(FilterBank, BilinearAndBicubicKeepRamps) {
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kBicubic}) {
    const FilterBank filter(interpolation);
    for (unsigned phase = 0; phase < kPhases; ++phase) {
      EXPECT_NEAR(Moment(filter, phase, 1), 0.0, 1e-12) << phase;  // exact by construction
    }
  }
}

TEST(FilterBank, BicubicKeepsParabolas) {
  // Two weights are rounded by half a unit each, at distances of up to 2.
  const double tolerance = 0.5 * (4.0 + 4.0) / kOne;
  const FilterBank filter(Interpolation::kBicubic);
  for (unsigned phase = 0; phase < kPhases; ++phase) {
    EXPECT_NEAR(Moment(filter, phase, 2), 0.0, tolerance) << phase;
  }
}

TEST(FilterBank, LanczosIsTheWindowedSinc) {
  const FilterBank filter(Interpolation::kLanczos);
  ASSERT_EQ(filter.taps(), 6);
  // sinc(x) sinc(x / 3) at 1/2, 3/2, 5/2, normalised to sum one, worked out by hand.
  const double near = 0.607927;
  const double middle = -0.135095;
  const double far = 0.024317;
  const double sum = 2.0 * (near + middle + far);
  const std::vector<int> weights = WeightsOf(filter, kPhases / 2);
  for (const auto& [tap, value] :
       {std::pair{0, far}, {1, middle}, {2, near}, {3, near}, {4, middle}, {5, far}}) {
    EXPECT_NEAR(weights[static_cast<std::size_t>(tap)], value / sum * kOne, 2.0) << tap;
  }
}

}  // namespace
}  // namespace rsstab::stabilizer
