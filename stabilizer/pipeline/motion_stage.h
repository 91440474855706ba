// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_MOTION_STAGE_H_
#define RSSTAB_STABILIZER_PIPELINE_MOTION_STAGE_H_

#include <memory>
#include <optional>
#include <vector>

#include "igf/base/frame.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/pipeline/clip_geometry.h"
#include "stabilizer/pipeline/frame_observation.h"
#include "stabilizer/pipeline/rs_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// From observations to finished frame analyses: asks the rolling-shutter source, estimates the
// motion between frames, smooths the bundled paths, plans the crop. Frames come out with a delay of
// the source's, the smoother's and the zoom planner's look-ahead; memory is bounded by it. In
// order, not thread safe.
class MotionStage {
 public:
  // `source` may look at pictures only if it says so (RsMotionSource::NeedsImage), and then `image`
  // must be given to Push. `lookahead_frames`: every frame is decided at the latest when this many
  // more have been pushed; empty: as many as serve the result best.
  // Errors: kInvalidArgument for options out of range.
  [[nodiscard]] static Result<std::unique_ptr<MotionStage>> Create(
      const StabilizeOptions& options, const ClipGeometry& clip, RsSelection* selection,
      Logger logger, std::optional<int> lookahead_frames = std::nullopt);
  ~MotionStage();
  MotionStage(const MotionStage&) = delete;
  MotionStage& operator=(const MotionStage&) = delete;

  [[nodiscard]] Status Push(const FrameObservation& observation, const FrameView* image = nullptr);
  [[nodiscard]] Status Finish();
  // Takes smoothness, tripod and crop of `options` for the frames not decided yet.
  [[nodiscard]] Status Update(const StabilizeOptions& options);
  // Frames decided since the last call.
  [[nodiscard]] std::vector<stabilizer::FrameAnalysis> TakeReady();

 private:
  struct Impl;
  explicit MotionStage(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_MOTION_STAGE_H_
