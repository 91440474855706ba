// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_STABILIZE_H_
#define RSSTAB_CLI_COMMANDS_STABILIZE_H_

#include "cli/command_context.h"
#include "cli/invocation.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// The main job: both passes, clip in, steady clip out.
[[nodiscard]] Status RunStabilize(const Invocation& invocation, const CommandContext& context);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_STABILIZE_H_
