// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/covered_map.h"

#include "stabilizer/crop_planner.h"

namespace rsstab::pipeline {
namespace {

constexpr int kMaxCropSteps = 100;
constexpr double kCropStep = 0.999;
// Rounding of the map to float; a source this far beyond the last pixel centre is that pixel.
constexpr double kRoundOffPx = 1e-3;

}  // namespace

CoveredMap ComposeCoveredMap(const stabilizer::FrameWarp& warp, double crop_ratio,
                             stabilizer::MapGrid grid) {
  for (int step = 0; step <= kMaxCropSteps; ++step) {
    CoveredMap covered{stabilizer::ComposeBackwardMap(stabilizer::WithCrop(warp, crop_ratio), grid),
                       crop_ratio};
    if (stabilizer::OverhangPx(covered.map) <= kRoundOffPx) {
      return covered;
    }
    crop_ratio *= kCropStep;
  }
  return {stabilizer::BackwardMap(warp.width, warp.height, grid.columns, grid.rows), 1.0};
}

}  // namespace rsstab::pipeline
