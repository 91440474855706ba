// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_RS_SOURCE_SELECTION_H_
#define RSSTAB_STABILIZER_PIPELINE_RS_SOURCE_SELECTION_H_

#include <optional>
#include <span>
#include <string>

#include "igf/base/camera.h"
#include "igf/base/log.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"
#include "igf/gyro_log.h"
#include "stabilizer/pipeline/motion_stage.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// What the host found beside the pictures. Files and telemetry tracks are read by the host.
struct RsInputs {
  std::optional<igf::GyroLog> gyro;  // camera axes, its own clock
  std::string gyro_origin;           // file or track it came from, for messages
  // The log was recorded into the clip: both clocks agree but for a fraction of a second.
  bool gyro_shares_clock = false;
  std::optional<Camera> camera;     // any size; rescaled to the clip's
  std::optional<double> readout_s;  // from the telemetry, when it says so
};

// True when the choice can only be made once the tracks of the clip are known (a gyro log must be
// brought into step with the picture first).
[[nodiscard]] bool NeedsTracks(const StabilizeOptions& options, const RsInputs& inputs);

// Chooses the rolling-shutter source, and says why. `tracks`: of consecutive frames, needed when
// NeedsTracks(); may be thinned out. With kAuto an untrustworthy gyro means no correction and a
// warning; with kGyro it is an error: kNotFound without a log, kUntrustworthy when it does not fit.
// With kDiffusion: the errors of rsdiff::FindModel and rsdiff::SingleImageEstimator::Load.
[[nodiscard]] Result<RsSelection> SelectRsSource(const StabilizeOptions& options,
                                                 const ClipGeometry& clip, const RsInputs& inputs,
                                                 std::span<const PointTracks> tracks,
                                                 const Logger& logger);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_RS_SOURCE_SELECTION_H_
