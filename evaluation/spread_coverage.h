// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_SPREAD_COVERAGE_H_
#define RSSTAB_EVALUATION_SPREAD_COVERAGE_H_

#include <array>
#include <cstdint>
#include <span>

#include "evaluation/readout_curve.h"
#include "igf/base/result.h"
#include "rsdiff/rotation_curve.h"

namespace rsstab::evaluation {

// The interval that the truth should lie in 80% of the time.
inline constexpr double kCentralShare = 0.8;
// So many samples at least: below them the 10% quantile lies outside the sample.
inline constexpr int kLeastCoverageSamples = 9;
// Bands around the middle row that do not count: everything is zero there.
inline constexpr int kMiddleBands = 4;

// How often the truth lay inside.
struct Coverage {
  std::int64_t inside = 0;
  std::int64_t total = 0;

  [[nodiscard]] double Share() const;  // NaN when nothing was counted
  Coverage& operator+=(const Coverage& other);
};

// Of (a, b, r).
using AxisCoverage = std::array<Coverage, 3>;

// Counts, for each axis and every band but the middle ones, whether the true value lies inside the
// central 80% of the samples, ends included. Quantiles are taken at position share * (n + 1) of the
// ordered samples (linear in between), with which n samples of the truth's own distribution cover
// it 80% of the time, whatever n is; the usual position share * (n - 1) + 1 would give 71% for 16.
// Errors: kInvalidArgument for fewer than kLeastCoverageSamples curves, or curves of different or
// no more than kMiddleBands bands.
[[nodiscard]] Result<AxisCoverage> CountCoverage(const rsdiff::RotationCurve& truth,
                                                 std::span<const rsdiff::RotationCurve> samples);

// The true curve at the centres of equal row bands.
[[nodiscard]] rsdiff::RotationCurve BandsOfCurve(const ReadoutCurve& curve, int bands);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_SPREAD_COVERAGE_H_
