// SPDX-License-Identifier: Apache-2.0
#include "evaluation/spread_coverage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace rsstab::evaluation {
namespace {

// Order statistic at a position counted from 1, linear in between; inside the sample for
// kLeastCoverageSamples and more.
double OrderStatistic(const std::vector<double>& sorted, double position) {
  const double from_zero = std::clamp(position - 1.0, 0.0, static_cast<double>(sorted.size() - 1));
  const auto below = static_cast<std::size_t>(from_zero);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], from_zero - static_cast<double>(below));
}

}  // namespace

double Coverage::Share() const {
  return total > 0 ? static_cast<double>(inside) / static_cast<double>(total)
                   : std::numeric_limits<double>::quiet_NaN();
}

Coverage& Coverage::operator+=(const Coverage& other) {
  inside += other.inside;
  total += other.total;
  return *this;
}

Result<AxisCoverage> CountCoverage(const rsdiff::RotationCurve& truth,
                                   std::span<const rsdiff::RotationCurve> samples) {
  const std::size_t bands = truth.size();
  const bool alike = std::all_of(samples.begin(), samples.end(),
                                 [bands](const auto& curve) { return curve.size() == bands; });
  if (static_cast<int>(samples.size()) < kLeastCoverageSamples || !alike ||
      static_cast<int>(bands) <= kMiddleBands) {
    return Fail(ErrorCode::kInvalidArgument,
                "the spread of {} curves against one of {} bands cannot be judged: it takes {} "
                "curves of the same number of bands, and more than {} bands",
                samples.size(), bands, kLeastCoverageSamples, kMiddleBands);
  }
  const double tail = (1.0 - kCentralShare) / 2.0;
  const auto places = static_cast<double>(samples.size() + 1);
  const auto first_middle = static_cast<int>(bands - kMiddleBands) / 2;
  AxisCoverage coverage;
  std::vector<double> values(samples.size());
  for (int band = 0; band < static_cast<int>(bands); ++band) {
    if (band >= first_middle && band < first_middle + kMiddleBands) {
      continue;
    }
    const auto b = static_cast<std::size_t>(band);
    for (int axis = 0; axis < 3; ++axis) {
      std::transform(samples.begin(), samples.end(), values.begin(),
                     [b, axis](const auto& curve) { return curve[b][axis]; });
      std::sort(values.begin(), values.end());
      Coverage& count = coverage[static_cast<std::size_t>(axis)];
      const double value = truth[b][axis];
      count.inside += value >= OrderStatistic(values, tail * places) &&
                              value <= OrderStatistic(values, (1.0 - tail) * places)
                          ? 1
                          : 0;
      ++count.total;
    }
  }
  return coverage;
}

rsdiff::RotationCurve BandsOfCurve(const ReadoutCurve& curve, int bands) {
  rsdiff::RotationCurve values;
  for (int band = 0; band < bands; ++band) {
    // Bands are the rows of a picture of that many rows.
    values.push_back(curve.AtRow(band, bands));
  }
  return values;
}

}  // namespace rsstab::evaluation
