// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CALIBRATE_H_
#define RSSTAB_CLI_COMMANDS_CALIBRATE_H_

#include <string>

#include "cli/command_context.h"
#include "cli/invocation.h"
#include "igf/base/result.h"
#include "stabilizer/pipeline/calibrator.h"

namespace rsstab::cli {

// What was found, for people (with the curve of the tracks as text), as one JSON object, and as a
// chart of all curves (an SVG file). `clip`: its name. The texts end with a line feed.
[[nodiscard]] std::string FormatCalibrationText(const pipeline::CalibrationReport& report,
                                                const std::string& clip);
[[nodiscard]] std::string FormatCalibrationJson(const pipeline::CalibrationReport& report,
                                                const std::string& clip);
[[nodiscard]] std::string FormatCalibrationChart(const pipeline::CalibrationReport& report);

// Looks at the clip, prints to standard output what it tells about its camera, and writes the files
// asked for. Errors: those of reading and writing; kCancelled.
[[nodiscard]] Status RunCalibrate(const Invocation& invocation, const CommandContext& context);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CALIBRATE_H_
