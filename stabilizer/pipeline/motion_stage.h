// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_MOTION_STAGE_H_
#define RSSTAB_STABILIZER_PIPELINE_MOTION_STAGE_H_

#include <memory>
#include <optional>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "igf/base/rs_motion_source.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/clip_calibration.h"
#include "stabilizer/pipeline/frame_observation.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// What the stage must know about the clip before the first frame.
struct ClipGeometry {
  int width = 0;  // full size, px
  int height = 0;
  double frames_per_second = 30.0;
};

// The rolling-shutter source of a clip, and the camera that goes with it.
struct RsSelection {
  std::unique_ptr<RsMotionSource> source;  // null: rolling shutter is left alone
  std::optional<Camera> camera;            // full size; set when anything is known about it
  double readout_s = 0.0;
  // The source's orientation is all that moves the picture (a gyro log, or tracks without
  // parallax): camera paths are then rotations.
  bool rotation_is_known = false;
  // So well that whatever else moves is an object of the scene: nothing may follow it.
  bool only_turns = false;
  std::optional<double> gyro_offset_s;
  std::optional<stabilizer::ClipCalibration> calibration;  // what the clip told, if asked
  std::string reason;  // one sentence for the log and the analysis file
};

// From observations to finished frame analyses: takes rolling shutter and lens out of the tracks,
// estimates global and local motion, smooths the bundled paths, plans the crop. Frames come out
// with a delay of the smoother's and the zoom planner's look-ahead; memory is bounded by it. In
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
