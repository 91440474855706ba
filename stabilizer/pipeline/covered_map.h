// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_COVERED_MAP_H_
#define RSSTAB_STABILIZER_PIPELINE_COVERED_MAP_H_

#include "stabilizer/backward_map.h"

namespace rsstab::pipeline {

struct CoveredMap {
  stabilizer::BackwardMap map;
  double crop_ratio = 1.0;  // kept share of a side
};

// The map of `warp` seen through a centred crop of at most `crop_ratio`, on whose every output
// pixel the picture has a source. The planner of the ratio looked at the outline of the crop in a
// finite number of points; here the map that is rendered is checked on every vertex, which is
// exact, and the crop is narrowed by thousandths until it holds. The identity when no such crop is
// found.
[[nodiscard]] CoveredMap ComposeCoveredMap(const stabilizer::FrameWarp& warp, double crop_ratio,
                                           stabilizer::MapGrid grid);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_COVERED_MAP_H_
