// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_RUN_COMMAND_H_
#define RSSTAB_CLI_RUN_COMMAND_H_

#include "cli/invocation.h"

namespace rsstab::cli {

// Runs the command that was asked for, with messages and progress on standard error. Returns the
// exit code. No exception leaves it.
[[nodiscard]] int RunCommand(const Invocation& invocation);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_RUN_COMMAND_H_
