// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_RECORDING_H_
#define RSSTAB_IGF_GYRO_RECORDING_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "igf/gyro_log.h"

namespace rsstab::igf {

// What a telemetry file or track says: the gyro log and what else a stabilizer can use.
struct GyroRecording {
  GyroLog gyro;
  std::string format;               // for people: "GPMF", "gcsv", "csv", "gyroflow"
  std::string device_name;          // empty when not told
  std::optional<double> readout_s;  // signed, see igf/base/rolling_shutter.h
  // What was assumed, repaired or left out, one sentence each; worth a warning.
  std::vector<std::string> notes;
};

// What the caller knows better than the file.
struct GyroParseOptions {
  // Sensor readings as stored -> camera axes, instead of what the file says. See imu_axes.h.
  std::optional<Eigen::Matrix3d> camera_from_sensor;
  GyroLogOptions limits;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_RECORDING_H_
