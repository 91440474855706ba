// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_RS_MOTION_FUSION_H_
#define RSSTAB_STABILIZER_RS_MOTION_FUSION_H_

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "igf/so3_spline.h"
#include "stabilizer/rs_motion_window.h"
#include "stabilizer/track_cells.h"

namespace rsstab::stabilizer {

// How the camera turned around one frame.
struct FusedFrame {
  // When its middle row was exposed, on the clock of `spline`: the frame's time, or that of the
  // frame that it repeats. Where timestamps are damaged (frames crowded together), a clock that
  // runs evenly from there to the end of the part.
  double time_s = 0.0;
  // Frames of the same part share one world frame; a cut begins another part.
  std::int64_t part = 0;
  // Covers the frame's readout. Empty: nothing is known (no tracks to either neighbour).
  std::optional<igf::So3Spline> spline;
};

// Frame pairs solved together: a frame is decided at the latest when so many more were pushed that
// do not repeat the one before.
inline constexpr int kFusionDelayFrames = 45;

// One continuous rotation for a whole clip (Ringaby and Forssen 2012, with the readout known and
// every row in its place), solved in windows that slide over the clip: each window begins with the
// knots that the earlier ones decided, and decides all but its last ones. Linear time; memory of
// one window. In order, not thread safe.
class RsMotionFusion {
 public:
  explicit RsMotionFusion(const RsMotionModel& model) : model_(model) {}

  // The next frame, with its tracks from the one before. A pair without cells (the first frame, a
  // cut), a long pause and a clock that does not advance begin another part.
  void Push(double time_s, FramePairCells pair);
  // No more frames will come.
  void Finish();

  // Frames decided since the last call, in order.
  [[nodiscard]] std::vector<FusedFrame> TakeReady();

 private:
  struct WaitingFrame {
    double time_s;
    std::int64_t part;
  };
  // Solves what is pending; decides the frames up to the last `tail` ones.
  void SolveWindow(std::size_t tail);
  void EndPart();
  void EmitFrames(double decided_until_s, const SplineStretch& stretch);

  RsMotionModel model_;
  std::int64_t part_ = 0;
  double last_time_s_ = -std::numeric_limits<double>::infinity();
  double clock_offset_s_ = 0.0;  // of the splines' clock against the frames'
  double content_time_s_ = 0.0;  // when the last frame's picture was taken, splines' clock
  int num_repeats_ = 0;
  std::vector<FramePairCells> pending_;
  SplineStretch stretch_;
  std::size_t num_fixed_ = 1;
  std::deque<WaitingFrame> waiting_;
  std::vector<FusedFrame> ready_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_RS_MOTION_FUSION_H_
