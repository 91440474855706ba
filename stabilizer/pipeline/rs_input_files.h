// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_RS_INPUT_FILES_H_
#define RSSTAB_STABILIZER_PIPELINE_RS_INPUT_FILES_H_

#include <string>

#include "igf/base/log.h"
#include "igf/base/result.h"
#include "igf/gyro_log_reader.h"
#include "stabilizer/pipeline/rs_inputs.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::pipeline {

// The camera file that `options` name, for a clip of width x height; nothing when they name none.
// Errors: those of igf::ReadCameraProfile and igf::ProfileForVideo.
[[nodiscard]] Result<RsInputs> ReadCameraInput(const StabilizeOptions& options, int width,
                                               int height);

// How `options` want a gyro log to be read. Errors: kInvalidArgument for the axes.
[[nodiscard]] Result<igf::GyroParseOptions> GyroParseOptionsFrom(const StabilizeOptions& options);

// Takes a recording over; its notes are logged as warnings. `origin`: file or track it came from.
void AddGyro(igf::GyroRecording recording, const std::string& origin, const Logger& logger,
             RsInputs& inputs);

// All of it for hosts that do not demux: camera file and gyro log (.gcsv, CSV, .gyroflow).
// Errors: those of the above; kUnsupported when the log is a video.
[[nodiscard]] Result<RsInputs> ReadRsInputFiles(const StabilizeOptions& options, int width,
                                                int height, const Logger& logger);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_RS_INPUT_FILES_H_
