// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_ONLINE_RS_SOURCE_H_
#define RSSTAB_STABILIZER_PIPELINE_ONLINE_RS_SOURCE_H_

#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/pipeline/clip_geometry.h"
#include "stabilizer/pipeline/online_options.h"
#include "stabilizer/pipeline/rs_source_selection.h"

namespace rsstab::pipeline {

// Chooses the rolling-shutter source of a clip that is not known yet:
//   gyro          with the offset that `options` give
//   fused, tracks with a readout time that is given, and MinFusedLookahead() frames of look-ahead
//   diffusion     each picture by itself
//   auto          gyro or fused where the above holds, else none; the reason says what was missing
// Errors: kUnsupported for a choice that lacks what it needs here; those of SelectRsSource.
[[nodiscard]] Result<RsSelection> SelectOnlineRsSource(const OnlineOptions& options,
                                                       const ClipGeometry& clip, RsInputs inputs,
                                                       const Logger& logger);

// Shortest look-ahead that leaves the smoother something after the fused source took its share.
[[nodiscard]] int MinFusedLookahead();

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_ONLINE_RS_SOURCE_H_
