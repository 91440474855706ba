// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_INFO_H_
#define RSSTAB_CLI_COMMANDS_INFO_H_

#include "cli/command_context.h"
#include "cli/invocation.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Prints on standard output what the clip holds and what would be done with it.
[[nodiscard]] Status RunInfo(const Invocation& invocation, const CommandContext& context);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_INFO_H_
