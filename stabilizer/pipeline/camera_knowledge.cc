// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/camera_knowledge.h"

#include "igf/camera_profile_reader.h"

namespace rsstab::pipeline {

CameraKnowledge WhatIsKnown(const StabilizeOptions& options, const ClipGeometry& clip,
                            const RsInputs& inputs) {
  CameraKnowledge known;
  if (inputs.camera) {
    known.camera = inputs.camera->Rescaled(clip.width, clip.height);
    known.focal_is_known = true;
    known.lens_is_known = true;
  } else {
    known.camera = Camera::Pinhole(clip.width, clip.height, igf::kFocalPrior * clip.width);
  }
  if (options.focal_px) {
    const double aspect = known.camera.fy / known.camera.fx;
    known.camera.fx = *options.focal_px;
    known.camera.fy = *options.focal_px * aspect;
    known.focal_is_known = true;
  }
  if (options.readout_s) {
    known.camera.readout_s = *options.readout_s;
  } else if (!known.camera.readout_s && inputs.readout_s) {
    known.camera.readout_s = *inputs.readout_s;
  }
  return known;
}

}  // namespace rsstab::pipeline
