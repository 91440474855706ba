// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_QUALITY_METRICS_H_
#define RSSTAB_STABILIZER_QUALITY_METRICS_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/result.h"
#include "stabilizer/metrics/path_metrics.h"

namespace rsstab::stabilizer {

// How good a clip looks, without any truth. px at 640 px width; empty = could not be measured (too
// short, nothing to track). How each figure is defined is said where it is computed
// (stabilizer/metrics/); docs/metrics.md tells how the definitions were settled and how far they
// reproduce published figures.
struct ClipMetrics {
  std::int64_t frames = 0;
  std::int64_t unmeasured_motions = 0;   // frame pairs with too few or contradicting tracks
  double tracks_per_frame = 0.0;         // mean over the frame pairs
  std::optional<double> wobble;          // px; what one homography per frame pair leaves over
  std::optional<double> row_wobble;      // px; its part common to rows
  std::optional<double> jitter;          // px; change of the motion from frame to frame
  std::optional<double> shake;           // px; path less its 0.25 s mean
  std::optional<double> stability;       // [0, 1]; the smaller of the next two
  std::optional<double> stability_move;  // translation
  std::optional<double> stability_turn;  // rotation
  std::optional<double> itf_db;  // mean PSNR of consecutive frames, native size, luma as stored
};

// Measures one clip, frame by frame. Keeps the previous picture and about 100 bytes for each frame
// of the clip. In order, not thread safe.
class ClipMeter {
 public:
  ClipMeter();
  ~ClipMeter();
  ClipMeter(ClipMeter&&) noexcept;
  ClipMeter& operator=(ClipMeter&&) noexcept;

  // The next frame; its samples are only read during the call.
  // Errors: kInvalidArgument for a frame without samples or of another size or depth than the
  // first.
  [[nodiscard]] Status Push(const FrameView& frame);

  // Figures of all frames so far. `frames_per_second` > 0: frames count as evenly spaced, since
  // container times of real clips are often damaged; use the clip's mean rate.
  [[nodiscard]] ClipMetrics Measure(double frames_per_second) const;

  // The picture's pose in each frame so far; motions that could not be measured count as none.
  [[nodiscard]] std::vector<PicturePose> Path() const;
  // What the last frame's content moved at the picture's centre, px at 640 px width; empty where
  // that could not be measured.
  [[nodiscard]] std::optional<Eigen::Vector2d> LastStep() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_QUALITY_METRICS_H_
