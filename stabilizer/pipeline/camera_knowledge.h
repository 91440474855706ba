// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_CAMERA_KNOWLEDGE_H_
#define RSSTAB_STABILIZER_PIPELINE_CAMERA_KNOWLEDGE_H_

#include <optional>

#include "igf/base/camera.h"
#include "stabilizer/clip_calibration.h"
#include "stabilizer/pipeline/clip_geometry.h"
#include "stabilizer/pipeline/rs_inputs.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// What is known of the camera before the clip is looked at.
struct CameraKnowledge {
  Camera camera;  // of the clip's size
  bool focal_is_known = false;
  bool lens_is_known = false;
};

// The user's word goes before the camera file, that before the telemetry, that before a guess.
[[nodiscard]] CameraKnowledge WhatIsKnown(const StabilizeOptions& options, const ClipGeometry& clip,
                                          const RsInputs& inputs);

// What the clip's calibration has to find out, from what is known already.
[[nodiscard]] stabilizer::ClipCalibrationOptions CalibrationOptions(const StabilizeOptions& options,
                                                                    const ClipGeometry& clip,
                                                                    const RsInputs& inputs);

// The lens to take out of the tracks; empty when none is known.
[[nodiscard]] std::optional<Camera> KnownLens(const StabilizeOptions& options,
                                              const ClipGeometry& clip, const RsInputs& inputs);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_CAMERA_KNOWLEDGE_H_
