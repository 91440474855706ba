// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_RS_INPUTS_H_
#define RSSTAB_STABILIZER_PIPELINE_RS_INPUTS_H_

#include <optional>
#include <string>

#include "igf/base/camera.h"
#include "igf/gyro_log.h"

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

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_RS_INPUTS_H_
