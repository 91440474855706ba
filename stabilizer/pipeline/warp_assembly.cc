// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/warp_assembly.h"

#include "stabilizer/normalized_coordinates.h"

namespace rsstab::pipeline {

stabilizer::FrameWarp AssembleWarp(const stabilizer::FrameAnalysis& frame, int width, int height,
                                   const std::optional<Camera>& camera) {
  stabilizer::FrameWarp warp;
  warp.width = width;
  warp.height = height;
  warp.rectified_from_output = stabilizer::PixelsFromNormalized(width, height) *
                               frame.rectified_from_output *
                               stabilizer::NormalizedFromPixels(width, height);
  warp.mesh_update = frame.mesh_update;
  warp.rs_field = frame.rs_field;
  if (camera && camera->model != LensModel::kPinhole) {
    warp.lens = camera;
  }
  return warp;
}

}  // namespace rsstab::pipeline
