// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SAMPLE_CLOCK_H_
#define RSSTAB_IGF_SAMPLE_CLOCK_H_

#include <span>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::igf {

// A sample of which both the running number and (roughly) the time are known.
struct ClockMark {
  double sample = 0.0;  // running number of a sample, strictly increasing over the marks
  double time_s = 0.0;
};

// Time of every sample of an evenly running sensor, from marks that jitter.
//
// A sensor delivers samples evenly, but they are stamped in packets: the packet's time is off by
// several samples, while the count is exact. So the time is a robust straight line through the
// marks (median of slopes, then least squares over the marks that lie near it), which one false
// stamp cannot bend. Sensor clocks drift with temperature, hence for long logs the line is fitted
// to windows of kWindow marks to either side, and interpolated in between.
class SampleClock {
 public:
  static constexpr int kWindow = 60;  // about a minute of GoPro payloads

  // At least 2 marks. Errors: kCorruptData when the marks are fewer, not finite, not in order of
  // samples, or do not tell a positive rate.
  [[nodiscard]] static Result<SampleClock> Fit(std::span<const ClockMark> marks);

  // A clock that runs evenly from `start_s`. interval_s > 0.
  [[nodiscard]] static SampleClock Even(double start_s, double interval_s);

  // Time of sample number `sample`, s. Increases with `sample`; extrapolates outside the marks.
  [[nodiscard]] double TimeOf(double sample) const;

  // The same clock, later by `offset_s`.
  void Shift(double offset_s);

 private:
  std::vector<ClockMark> knots_;  // at least 2, both columns strictly increasing
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SAMPLE_CLOCK_H_
