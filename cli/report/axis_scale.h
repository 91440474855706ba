// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_AXIS_SCALE_H_
#define RSSTAB_CLI_REPORT_AXIS_SCALE_H_

#include <string>
#include <vector>

namespace rsstab::report {

// The values that an axis spans, and where its ticks stand: at multiples of `step`, which is 1, 2
// or 5 times a power of ten.
struct AxisScale {
  double low = 0.0;
  double high = 1.0;
  double step = 0.2;

  // Place of a value along the axis: 0 at low, 1 at high.
  [[nodiscard]] double Place(double value) const { return (value - low) / (high - low); }
  // Within [low, high], rising.
  [[nodiscard]] std::vector<double> Ticks() const;
  // With as many decimals as the step has; "0" never has a sign.
  [[nodiscard]] std::string Label(double tick) const;
};

// A scale of about `wanted_ticks` ticks (at least 2) for values from `low` to `high`. Where
// `whole_steps`, the axis ends on ticks; else it spans the values exactly. Equal values are given
// some room; values that are not finite give the scale from 0 to 1.
[[nodiscard]] AxisScale MakeAxisScale(double low, double high, int wanted_ticks, bool whole_steps);

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_AXIS_SCALE_H_
