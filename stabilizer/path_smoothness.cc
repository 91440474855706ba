// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stabilizer/path_smoothness_detail.h"

namespace rsstab::stabilizer {
namespace {

// Away from borders the smoother passes |P| = |C| / (1 + ((w/w2)^4 + (w/w3)^6) / kDataWeight^2) of
// a motion of angular frequency w; w2 and w3 are these shares of 2 pi / smoothness_s.
constexpr double kAccelerationCutoff = 0.20;
constexpr double kJerkCutoff = 0.25;
// With a look-ahead smoothness_s is at most this, and so much more for each second of it.
constexpr double kCausalSmoothnessS = 0.5;
constexpr double kSmoothnessPerLookahead = 1.5;

}  // namespace

double LookaheadSeconds(const PathSmootherOptions& options) {
  return options.lookahead_frames ? *options.lookahead_frames / options.frames_per_second
                                  : std::numeric_limits<double>::infinity();
}

double SmoothnessFrames(const PathSmootherOptions& options) {
  const double attainable_s =
      kCausalSmoothnessS + kSmoothnessPerLookahead * LookaheadSeconds(options);
  return std::min(options.smoothness_s, attainable_s) * options.frames_per_second;
}

TemporalWeights MakeTemporalWeights(const PathSmootherOptions& options) {
  const double radians_per_frame =
      2.0 * std::numbers::pi / std::max(SmoothnessFrames(options), 1.0);
  return {std::pow(kAccelerationCutoff * radians_per_frame, -2.0),
          std::pow(kJerkCutoff * radians_per_frame, -3.0)};
}

}  // namespace rsstab::stabilizer
