// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_RENDER_H_
#define RSSTAB_CLI_COMMANDS_RENDER_H_

#include "cli/command_context.h"
#include "cli/invocation.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Pass 2 alone: reads the analysis file, writes the steady clip.
[[nodiscard]] Status RunRender(const Invocation& invocation, const CommandContext& context);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_RENDER_H_
