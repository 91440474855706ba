// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_RS_INPUTS_H_
#define RSSTAB_CLI_RS_INPUTS_H_

#include "cli/media/video_info.h"
#include "igf/base/log.h"
#include "igf/base/result.h"
#include "stabilizer/pipeline/rs_source_selection.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::cli {

// Reads what the options name, and the clip's own telemetry track where no gyro log is named: gyro
// and camera of the clip. What a file is silent or wrong about is told as a warning.
// Errors: those of the readers, naming the file. The clip's own track is only allowed to be
// unreadable when no gyro is asked for (RsChoice::kAuto).
[[nodiscard]] Result<pipeline::RsInputs> ReadRsInputs(const pipeline::StabilizeOptions& options,
                                                      const media::VideoInfo& clip,
                                                      const Logger& logger);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_RS_INPUTS_H_
