// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_WARP_ASSEMBLY_H_
#define RSSTAB_STABILIZER_PIPELINE_WARP_ASSEMBLY_H_

#include <optional>

#include "igf/base/camera.h"
#include "stabilizer/analysis_file.h"
#include "stabilizer/backward_map.h"

namespace rsstab::pipeline {

// The warp that a frame's analysis stands for, in pixels of width x height, without crop.
// `camera`: of that size; only a lens with distortion enters the warp.
[[nodiscard]] stabilizer::FrameWarp AssembleWarp(const stabilizer::FrameAnalysis& frame, int width,
                                                 int height, const std::optional<Camera>& camera);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_WARP_ASSEMBLY_H_
