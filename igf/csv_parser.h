// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_CSV_PARSER_H_
#define RSSTAB_IGF_CSV_PARSER_H_

#include <ostream>
#include <string_view>

#include "igf/base/result.h"
#include "igf/gyro_recording.h"

namespace rsstab::igf {

// Gyro log as plain CSV. The first line that is not blank or a comment (#, //, %) names the
// columns, in any order, beside any others:
//   time    t, time, timestamp, ts; seconds
//   rates   gx gy gz, wx wy wz, gyro_x ..; rad/s, in camera axes (x right, y down, z forward)
// A unit may follow, after an underscore or in brackets: "t_ms", "time (us)", "gx_dps",
// "gyro_x [deg/s]". Separated by commas, semicolons or tabs. options.camera_from_sensor turns rates
// that are not in camera axes.
// Errors: kCorruptData with the line number; what GyroLog::Create refuses.
[[nodiscard]] Result<GyroRecording> ParseGyroCsv(std::string_view text,
                                                 const GyroParseOptions& options = {});

// Writes a log that ParseGyroCsv reads back exactly: "t,gx,gy,gz", seconds, rad/s, camera axes.
// The caller checks the stream's state.
void WriteGyroCsv(const GyroLog& log, std::ostream& out);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_CSV_PARSER_H_
