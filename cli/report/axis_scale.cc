// SPDX-License-Identifier: Apache-2.0
#include "cli/report/axis_scale.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rsstab::report {
namespace {

// Rounding may put a tick this share of a step beyond the end of the axis.
constexpr double kSlack = 1e-6;
// Below this share of its size a range is rounding noise of the numbers themselves.
constexpr double kNoRange = 1e-9;

double NiceStep(double raw) {
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power * (1.0 + kSlack)) {
      return factor * power;
    }
  }
  return 10.0 * power;
}

}  // namespace

std::vector<double> AxisScale::Ticks() const {
  std::vector<double> ticks;
  const auto first = static_cast<long long>(std::ceil(low / step - kSlack));
  const auto last = static_cast<long long>(std::floor(high / step + kSlack));
  for (long long i = first; i <= last; ++i) {
    ticks.push_back(static_cast<double>(i) * step);
  }
  return ticks;
}

std::string AxisScale::Label(double tick) const {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + kSlack)));
  if (std::abs(tick) < 0.5 * step) {
    return "0";
  }
  // A typographic minus is as wide as the digits.
  return (tick < 0.0 ? "\u2212" : "") + fmt::format("{:.{}f}", std::abs(tick), decimals);
}

AxisScale MakeAxisScale(double low, double high, int wanted_ticks, bool whole_steps) {
  if (!std::isfinite(low) || !std::isfinite(high)) {
    return {};
  }
  if (low > high) {
    std::swap(low, high);
  }
  const double size = std::max(std::abs(low), std::abs(high));
  if (high - low <= kNoRange * size || size == 0.0) {
    const double room = size > 0.0 ? 0.1 * size : 1.0;
    low -= room;
    high += room;
  }
  AxisScale scale{low, high, NiceStep((high - low) / std::max(1, wanted_ticks - 1))};
  if (whole_steps) {
    scale.low = scale.step * std::floor(low / scale.step + kSlack);
    scale.high = scale.step * std::ceil(high / scale.step - kSlack);
  }
  return scale;
}

}  // namespace rsstab::report
