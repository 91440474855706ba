// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/host_clock.h"

#include <cmath>

namespace rsstab::frei0r {
namespace {

// AV_NOPTS_VALUE, -2^63, is below this in any time base down to nanoseconds; no clip begins thirty
// years before its zero.
constexpr double kNoTimeBelow_s = -1e9;
constexpr double kLongStep = 1.0;
constexpr int kLongStepsThatTell = 2;

}  // namespace

std::optional<double> HostClock::Seconds(double host_time) {
  const double scale = unit_ == TimeUnit::kMilliseconds ? 1e-3 : 1.0;
  if (!std::isfinite(host_time) || host_time * scale < kNoTimeBelow_s) {
    return std::nullopt;
  }
  if (unit_ == TimeUnit::kUnknown) {
    long_steps_ = last_ && host_time - *last_ >= kLongStep ? long_steps_ + 1 : 0;
    last_ = host_time;
    if (long_steps_ == kLongStepsThatTell) {
      unit_ = TimeUnit::kMilliseconds;
      return host_time * 1e-3;
    }
  }
  return host_time * scale;
}

}  // namespace rsstab::frei0r
