// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_STATISTICS_H_
#define RSSTAB_EVALUATION_STATISTICS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace rsstab::evaluation {

// Small statistics of lists of numbers. Of an empty list they are NaN. Any thread.

[[nodiscard]] double Mean(std::span<const double> values);

// Standard error of the mean; NaN below two values.
[[nodiscard]] double StandardError(std::span<const double> values);

// Quantile by linear interpolation between order statistics, position share * (n - 1) counted from
// 0. `share` in [0, 1].
[[nodiscard]] double Quantile(std::span<const double> values, double share);

// y = intercept + slope x, by least squares.
struct LineFit {
  double slope = 0.0;
  double intercept = 0.0;
  double r_squared = 0.0;  // share of y's variance that the line explains
};
// NaN unless x varies. `x` and `y` of one length.
[[nodiscard]] LineFit FitLine(std::span<const double> x, std::span<const double> y);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

inline constexpr int kBootstrapResamples = 2000;

// Percentile bootstrap (Efron 1979): redraws `clusters` indices with replacement, `resamples`
// times, and takes the central `confidence` share of the statistic's values. Numbers of one
// photograph hang together, so photographs are redrawn, not single samples. Same seed, same
// interval. NaN without clusters.
[[nodiscard]] Interval BootstrapInterval(
    std::size_t clusters,
    const std::function<double(std::span<const std::size_t> drawn)>& statistic, std::uint64_t seed,
    double confidence = 0.95, int resamples = kBootstrapResamples);

// The same for the mean of values, each of which belongs to the cluster of the same index.
[[nodiscard]] Interval BootstrapMean(std::span<const double> values,
                                     std::span<const std::size_t> cluster_of, std::uint64_t seed,
                                     double confidence = 0.95);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_STATISTICS_H_
