// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYROFLOW_JSON_PARSER_H_
#define RSSTAB_IGF_GYROFLOW_JSON_PARSER_H_

#include <string_view>

#include "igf/base/result.h"
#include "igf/gyro_recording.h"

namespace rsstab::igf {

// Project file of the first, Python Gyroflow (".gyroflow", JSON with `raw_imu`): rows of
// t (s), gx, gy, gz (rad/s), and more, already turned to that program's axes: x right (positive
// pitches up), y up, z back. In camera axes that is (x, -y, -z).
// Projects of the present Gyroflow keep their log packed, or only name the video: kUnsupported.
// Errors: kCorruptData with the row; what GyroLog::Create refuses.
[[nodiscard]] Result<GyroRecording> ParseGyroflowJson(std::string_view text,
                                                      const GyroParseOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYROFLOW_JSON_PARSER_H_
