// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_SKEW_RESPONSE_H_
#define RSSTAB_EVALUATION_SKEW_RESPONSE_H_

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "evaluation/motion_method.h"
#include "evaluation/statistics.h"
#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/parallel_for.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// Multiples of one steady yaw; times 1 has a mean displacement of kUnitSkewMeanPx at 800x600.
inline constexpr std::array<double, 7> kSkewFactors = {-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0};
inline constexpr double kUnitSkewMeanPx = 4.0;

// Skew of a field, px: how much farther right the bottom row is displaced than the top row, by the
// least-squares line through the horizontal displacements of all vertices.
[[nodiscard]] double SkewOf(const MotionField& field);

// What a method says of a picture skewed by a known amount.
struct SkewAnswer {
  double factor = 0.0;
  double true_px = 0.0;
  double predicted_px = 0.0;
  double remainder_px = 0.0;  // predicted after correcting the picture with the true motion
};

// All factors for one photograph. The picture is recorded larger than 800x600 by a margin, and the
// method sees the middle of it before and after the correction, so that no border tells what was
// done. Errors: those of Expose, CorrectPicture and the method.
[[nodiscard]] Result<std::vector<SkewAnswer>> AskForSkew(const FrameView& photo,
                                                         MotionMethod& method, std::uint64_t seed,
                                                         WorkerPool& workers);

struct SkewLevel {
  double factor = 0.0;
  double true_px = 0.0;
  double predicted_px = 0.0;  // mean over the photos, and its standard error
  double predicted_error_px = 0.0;
  double remainder_px = 0.0;
  double remainder_error_px = 0.0;
};

// How the answers depend on the truth. Intervals: 95%, bootstrap over the photographs.
struct SkewResponse {
  int photos = 0;
  std::vector<SkewLevel> levels;
  LineFit fit;  // of predicted on true skew, all answers
  Interval slope_interval;
  double linearity = 0.0;     // share of the variance of the levels' means that a line explains
  double remainder_px = 0.0;  // mean over everything, and its standard error over the photos
  double remainder_error_px = 0.0;
  double remainder_slope = 0.0;  // of the remainder on the true skew before correcting
  // The candidate for the readout time, as a multiple of the true one, at which the predicted
  // remainder no longer goes with the motion: 1 + remainder_slope / slope. 1 is unbiased.
  double zero_crossing = 0.0;
  Interval zero_crossing_interval;
};

// One list of answers for each photograph, all with the same factors.
[[nodiscard]] SkewResponse SummariseSkew(std::span<const std::vector<SkewAnswer>> by_photo,
                                         std::uint64_t seed);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_SKEW_RESPONSE_H_
