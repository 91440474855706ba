// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_SCORE_SUMMARY_H_
#define RSSTAB_EVALUATION_SCORE_SUMMARY_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluation/spread_coverage.h"
#include "evaluation/statistics.h"
#include "evaluation/synthetic_protocol.h"

namespace rsstab::evaluation {

// One method over a group of pictures. Means over the pictures unless said otherwise.
struct MethodSummary {
  std::string method;
  std::size_t declined = 0;  // pictures left as they are because they did not tell
  double epe_px = 0.0;
  double epe_median_px = 0.0;
  double epe_p90_px = 0.0;
  double horizontal_px = 0.0;
  double vertical_px = 0.0;
  // Share of the uncorrected figure that is left: ratio of the means. NaN where that is
  // below 1 px (a stretch has next to no horizontal part, a still frame none at all).
  double epe_ratio = 0.0;
  double horizontal_ratio = 0.0;
  double vertical_ratio = 0.0;
  // End-point error less the uncorrected one of the same picture: mean, and its 95% interval
  // (bootstrap over the photographs). Below zero: better than leaving the frame as it is.
  double difference_px = 0.0;
  Interval difference_interval;
  double psnr_db = 0.0;
  double ssim = 0.0;
  double valid_share = 0.0;
  double ms = 0.0;
};

struct GroupSummary {
  bool structured_only = false;
  std::string motion;  // a motion class, or "all" for the moving ones together
  std::size_t pictures = 0;
  std::vector<MethodSummary> methods;
  std::optional<AxisCoverage> coverage;
};

// Each moving class, all of them together, and the still frames; then the same of the structured
// photographs, where there are any. The first method of every record is the uncorrected one.
[[nodiscard]] std::vector<GroupSummary> SummariseSamples(std::span<const SampleRecord> samples,
                                                         std::uint64_t seed);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_SCORE_SUMMARY_H_
