// SPDX-License-Identifier: Apache-2.0
#include "evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "igf/base/seeded_random.h"

namespace rsstab::evaluation {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double Mean(std::span<const double> values) {
  if (values.empty()) {
    return kNan;
  }
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double StandardError(std::span<const double> values) {
  if (values.size() < 2) {
    return kNan;
  }
  const double mean = Mean(values);
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  const auto n = static_cast<double>(values.size());
  return std::sqrt(squares / (n - 1.0) / n);
}

double Quantile(std::span<const double> values, double share) {
  if (values.empty()) {
    return kNan;
  }
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

LineFit FitLine(std::span<const double> x, std::span<const double> y) {
  const double mean_x = Mean(x);
  const double mean_y = Mean(y);
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  if (!(xx > 0.0)) {
    return {kNan, kNan, kNan};
  }
  const double slope = xy / xx;
  // A constant is explained by the line, whatever rounding says.
  const double r_squared = yy > 0.0 ? xy * xy / (xx * yy) : 1.0;
  return {slope, mean_y - slope * mean_x, r_squared};
}

Interval BootstrapInterval(
    std::size_t clusters,
    const std::function<double(std::span<const std::size_t> drawn)>& statistic, std::uint64_t seed,
    double confidence, int resamples) {
  if (clusters == 0 || resamples < 1) {
    return {kNan, kNan};
  }
  SeededRandom random(seed);
  std::vector<std::size_t> drawn(clusters);
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(resamples));
  for (int i = 0; i < resamples; ++i) {
    for (std::size_t& index : drawn) {
      index = static_cast<std::size_t>(random.Uniform() * static_cast<double>(clusters));
    }
    values.push_back(statistic(drawn));
  }
  const double tail = (1.0 - confidence) / 2.0;
  return {Quantile(values, tail), Quantile(values, 1.0 - tail)};
}

Interval BootstrapMean(std::span<const double> values, std::span<const std::size_t> cluster_of,
                       std::uint64_t seed, double confidence) {
  struct Total {
    double sum = 0.0;
    double count = 0.0;
  };
  std::map<std::size_t, Total> by_cluster;
  for (std::size_t i = 0; i < values.size(); ++i) {
    Total& total = by_cluster[cluster_of[i]];
    total.sum += values[i];
    total.count += 1.0;
  }
  std::vector<Total> totals;
  totals.reserve(by_cluster.size());
  for (const auto& [cluster, total] : by_cluster) {
    totals.push_back(total);
  }
  const auto mean_of = [&totals](std::span<const std::size_t> drawn) {
    Total all;
    for (const std::size_t index : drawn) {
      all.sum += totals[index].sum;
      all.count += totals[index].count;
    }
    return all.sum / all.count;
  };
  return BootstrapInterval(totals.size(), mean_of, seed, confidence);
}

}  // namespace rsstab::evaluation
