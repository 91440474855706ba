// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_CAMERA_KNOWLEDGE_H_
#define RSSTAB_STABILIZER_PIPELINE_CAMERA_KNOWLEDGE_H_

#include "igf/base/camera.h"
#include "stabilizer/pipeline/rs_source_selection.h"

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

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_CAMERA_KNOWLEDGE_H_
