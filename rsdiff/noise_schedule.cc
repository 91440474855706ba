// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/noise_schedule.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace rsstab::rsdiff {
namespace {

constexpr int kMaxSteps = 100000;
constexpr double kMaxBeta = 0.999;
// Of the linear schedule, over this many steps.
constexpr double kLinearSteps = 1000.0;
constexpr double kFirstBeta = 1e-4;
constexpr double kLastBeta = 0.02;
// Offset s of the cosine schedule: keeps the first betas away from 0.
constexpr double kCosineOffset = 0.008;

double LinearBeta(int t, int steps) {
  const double share = steps > 1 ? static_cast<double>(t) / (steps - 1) : 0.0;
  return kLinearSteps / steps * (kFirstBeta + share * (kLastBeta - kFirstBeta));
}

// f(u) of Nichol & Dhariwal 2021, eq. 17; a_t = f(t / T) / f(0).
double CosineSignal(double u) {
  const double c = std::cos((u + kCosineOffset) / (1.0 + kCosineOffset) * std::numbers::pi / 2.0);
  return c * c;
}

double CosineBeta(int t, int steps) {
  return 1.0 - CosineSignal((t + 1.0) / steps) / CosineSignal(static_cast<double>(t) / steps);
}

}  // namespace

Result<NoiseSchedule> NoiseSchedule::Create(ScheduleKind kind, int steps) {
  if (steps < 1 || steps > kMaxSteps) {
    return Fail(ErrorCode::kInvalidArgument, "a diffusion of {} steps must have 1 to {}", steps,
                kMaxSteps);
  }
  NoiseSchedule schedule;
  double signal = 1.0;
  for (int t = 0; t < steps; ++t) {
    const double beta = kind == ScheduleKind::kLinear ? LinearBeta(t, steps) : CosineBeta(t, steps);
    schedule.beta_.push_back(std::clamp(beta, 0.0, kMaxBeta));
    signal *= 1.0 - schedule.beta_.back();
    schedule.signal_.push_back(signal);
  }
  return schedule;
}

std::vector<std::pair<int, int>> DdimTimePairs(int steps, int sampling_steps) {
  // -1 + T i / n in whole numbers, so that no platform rounds it differently.
  const auto time = [&](int i) {
    return static_cast<int>(static_cast<std::int64_t>(steps) * i / sampling_steps) - 1;
  };
  std::vector<std::pair<int, int>> pairs;
  for (int i = sampling_steps; i > 0; --i) {
    pairs.emplace_back(time(i), time(i - 1));
  }
  return pairs;
}

}  // namespace rsstab::rsdiff
