// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_RS_SELECTION_H_
#define RSSTAB_STABILIZER_PIPELINE_RS_SELECTION_H_

#include <memory>
#include <optional>
#include <string>

#include "igf/base/camera.h"
#include "igf/base/rs_motion_source.h"
#include "stabilizer/clip_calibration.h"

namespace rsstab::pipeline {

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
  double covered_share = 1.0;                              // of the clip's frames, by the gyro log
  std::optional<stabilizer::ClipCalibration> calibration;  // what the clip told, if asked
  std::string reason;  // one sentence for the log and the analysis file
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_RS_SELECTION_H_
