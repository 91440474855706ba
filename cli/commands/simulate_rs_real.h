// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_SIMULATE_RS_REAL_H_
#define RSSTAB_CLI_COMMANDS_SIMULATE_RS_REAL_H_

#include "cli/commands/simulate.h"
#include "cli/commands/simulate_options.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// `simulate --rs-real`: writes options.samples labelled pictures in RS-Real's layout into
// options.output, each photograph in three strengths of motion in turn; consecutive frames of clips
// where options.frames is more than 1. Photographs that cannot be read are named by a warning, and
// the next one takes their place. The same options give the same files, for any number of threads.
// Errors: kInvalidArgument for options that make no sense, or when the folder holds samples and
// overwrite is off; those of ListPhotos and WriteRsRealClip; kCancelled.
[[nodiscard]] Status RunSimulateRsReal(const SimulateOptions& options, const Logger& logger,
                                       const SimulateProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_SIMULATE_RS_REAL_H_
