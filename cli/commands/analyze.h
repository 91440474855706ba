// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_ANALYZE_H_
#define RSSTAB_CLI_COMMANDS_ANALYZE_H_

#include "cli/command_context.h"
#include "cli/invocation.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Pass 1 alone: writes the analysis file.
[[nodiscard]] Status RunAnalyze(const Invocation& invocation, const CommandContext& context);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_ANALYZE_H_
