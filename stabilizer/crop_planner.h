// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_CROP_PLANNER_H_
#define RSSTAB_STABILIZER_CROP_PLANNER_H_

#include <cstddef>
#include <deque>
#include <vector>

#include "stabilizer/backward_map.h"

namespace rsstab::stabilizer {

// `warp` with a centred crop window of `crop_ratio` of each side blown up to the full output: the
// zoom comes first, output pixel -> window pixel -> warp.
[[nodiscard]] FrameWarp WithCrop(FrameWarp warp, double crop_ratio);

// The largest crop ratio in [kMinCropRatio, 1] whose window, seen through `warp` (which holds no
// crop), has a source inside the picture along its whole outline. kMinCropRatio when none has.
inline constexpr double kMinCropRatio = 0.1;
[[nodiscard]] double LargestCropRatio(const FrameWarp& warp);

// Turns the crop that every frame allows into a crop that changes slowly and never exceeds what is
// allowed: the smallest value of a sliding window, then a Gaussian mean over a window of the same
// reach. Every value that enters the mean at t already is at most what t allows, so is the mean.
class ZoomPlanner {
 public:
  // `reach`: frames on either side; 0 = follow the limit exactly.
  explicit ZoomPlanner(std::size_t reach);

  // The crop ratio that the next frame allows; `path_begins` starts afresh (a cut hides the jump).
  void Push(double allowed_ratio, bool path_begins);
  // No more frames will come.
  void Finish();
  // Planned ratios decided since the last call, one per frame, in order.
  [[nodiscard]] std::vector<double> TakeReady();

 private:
  void DecideUpTo(std::size_t end);

  std::vector<double> weights_;  // Gaussian, index = distance
  std::size_t reach_;
  std::deque<double> allowed_;  // of the current path
  std::size_t first_ = 0;       // frame number of allowed_.front() in the current path
  std::size_t decided_ = 0;     // frames of the current path already handed out
  std::size_t pushed_ = 0;      // frames of the current path
  std::vector<double> ready_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_CROP_PLANNER_H_
