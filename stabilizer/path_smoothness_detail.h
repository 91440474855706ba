// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PATH_SMOOTHNESS_DETAIL_H_
#define RSSTAB_STABILIZER_PATH_SMOOTHNESS_DETAIL_H_

#include "stabilizer/path_smoother.h"

namespace rsstab::stabilizer {

// Pull of the smooth path to the camera's own: weak, since the border keeps them together.
inline constexpr double kDataWeight = 0.5;

// How far the smoother looks ahead. Infinite in two passes.
[[nodiscard]] double LookaheadSeconds(const PathSmootherOptions& options);

// smoothness_s in frames, as far as the look-ahead lets it: what cannot be known cannot be
// smoothed.
[[nodiscard]] double SmoothnessFrames(const PathSmootherOptions& options);

// Square roots of the temporal terms' weights, since residuals are squared.
struct TemporalWeights {
  double acceleration = 0.0;
  double jerk = 0.0;
};
[[nodiscard]] TemporalWeights MakeTemporalWeights(const PathSmootherOptions& options);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_PATH_SMOOTHNESS_DETAIL_H_
