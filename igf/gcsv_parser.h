// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GCSV_PARSER_H_
#define RSSTAB_IGF_GCSV_PARSER_H_

#include <string_view>

#include "igf/base/result.h"
#include "igf/gyro_recording.h"

namespace rsstab::igf {

// True when the text begins as a .gcsv does: "GYROFLOW IMU LOG" or "CAMERA IMU LOG".
[[nodiscard]] bool IsGcsv(std::string_view text);

// Gyroflow's text log (docs.gyroflow.xyz, "GCSV format"): that title, lines of "key,value", a line
// of column names that begins with t, and rows.
//   t * tscale         seconds (tscale is 0.001 where not given, as Gyroflow takes it)
//   gx, gy, gz * gscale  rad/s (gscale 1)
//   orientation        Gyroflow's IMU orientation, "xzY" where not given; letter k says which
//   sensor
//                      axis supplies axis k of Gyroflow's body frame (x up, y left, z back), lower
//                      case negates. In camera axes that is (-y, -x, -z); see imu_axes.h.
//   frame_readout_time, frame_readout_direction   ms; 0 = top to bottom, 1 = bottom to top
//   vendor, id         the recording's device name
// options.camera_from_sensor replaces the orientation.
// Errors: kCorruptData with the line number; what GyroLog::Create refuses.
[[nodiscard]] Result<GyroRecording> ParseGcsv(std::string_view text,
                                              const GyroParseOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GCSV_PARSER_H_
