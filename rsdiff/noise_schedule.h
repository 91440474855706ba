// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_NOISE_SCHEDULE_H_
#define RSSTAB_RSDIFF_NOISE_SCHEDULE_H_

#include <utility>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::rsdiff {

enum class ScheduleKind {
  kLinear,  // Ho et al. 2020: beta from 1e-4 to 0.02 over 1000 steps; times 1000/T for other T
  kCosine,  // Nichol & Dhariwal 2021, s = 0.008, beta at most 0.999
};

// The forward process x_t = sqrt(a_t) x0 + sqrt(1 - a_t) noise, a_t = product of (1 - beta_s) over
// s <= t. Immutable.
class NoiseSchedule {
 public:
  // `steps` = T, 1 .. 100000. Betas above 0.999 (a linear schedule of few steps) are cut there.
  // Errors: kInvalidArgument for a T outside its range.
  [[nodiscard]] static Result<NoiseSchedule> Create(ScheduleKind kind, int steps);

  [[nodiscard]] int steps() const { return static_cast<int>(signal_.size()); }
  // beta_t and a_t, t in [0, T).
  [[nodiscard]] double Beta(int t) const { return beta_[static_cast<std::size_t>(t)]; }
  [[nodiscard]] double Signal(int t) const { return signal_[static_cast<std::size_t>(t)]; }

 private:
  std::vector<double> beta_;
  std::vector<double> signal_;
};

// The (t, next t) of `sampling_steps` DDIM steps from T - 1 down; the last next t is -1: neighbours
// in linspace(-1, T - 1, sampling_steps + 1), each cut to an integer, reversed (as published).
// sampling_steps in [1, T].
[[nodiscard]] std::vector<std::pair<int, int>> DdimTimePairs(int steps, int sampling_steps);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_NOISE_SCHEDULE_H_
