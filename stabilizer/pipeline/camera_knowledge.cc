// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/camera_knowledge.h"

#include <algorithm>
#include <thread>

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

stabilizer::ClipCalibrationOptions CalibrationOptions(const StabilizeOptions& options,
                                                      const ClipGeometry& clip,
                                                      const RsInputs& inputs) {
  const CameraKnowledge known = WhatIsKnown(options, clip, inputs);
  stabilizer::ClipCalibrationOptions calibration;
  calibration.frame_interval_s = 1.0 / clip.frames_per_second;
  calibration.readout_s = known.camera.readout_s;
  if (known.focal_is_known) {
    calibration.focal = known.camera.fx / known.camera.width;
  }
  calibration.num_threads =
      options.num_threads > 0 ? options.num_threads
                              : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return calibration;
}

std::optional<Camera> KnownLens(const StabilizeOptions& options, const ClipGeometry& clip,
                                const RsInputs& inputs) {
  const CameraKnowledge known = WhatIsKnown(options, clip, inputs);
  return known.lens_is_known ? std::optional<Camera>(known.camera) : std::nullopt;
}

}  // namespace rsstab::pipeline
