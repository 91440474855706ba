// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_WOBBLE_H_
#define RSSTAB_STABILIZER_METRICS_WOBBLE_H_

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "igf/base/point_tracks.h"

namespace rsstab::stabilizer {

// What one homography does not explain of the motion between consecutive frames. Adds up frames;
// keeps a few numbers only. Not thread safe.
class WobbleMeter {
 public:
  // Pictures of width x height pixels. height >= 1.
  WobbleMeter(int width, int height) : width_(width), height_(height) {}

  // Matches in reading order and the robust homography `to_from_from` fitted to them.
  void Add(std::span<const PointMatch> matches, const Eigen::Matrix3d& to_from_from);

  // Root mean square length of the residuals up to 8 px, over all matches of all frames; px at
  // 640 px width. Empty without matches.
  [[nodiscard]] std::optional<double> Wobble() const;

  // The part that the matches of a row band share, px at 640 px width: per frame, 18 bands of equal
  // height; in each, the matches are dealt in turn to two halves, and the two mean residuals are
  // multiplied (dot product), so that independent noise cancels; the frame's figure is the root of
  // the bands' mean product (0 when negative), the clip's the mean over frames. Bands with fewer
  // than 3 matches in a half are left out, and frames without any band. Empty without frames.
  [[nodiscard]] std::optional<double> RowWobble() const;

 private:
  int width_;
  int height_;
  double squares_ = 0.0;
  std::size_t matches_ = 0;
  double row_sum_ = 0.0;
  std::size_t row_frames_ = 0;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_WOBBLE_H_
