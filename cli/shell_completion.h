// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_SHELL_COMPLETION_H_
#define RSSTAB_CLI_SHELL_COMPLETION_H_

#include <string>

namespace rsstab::cli {

// A bash script that completes commands, options, the words an option takes, and file names.
[[nodiscard]] std::string BashCompletion();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_SHELL_COMPLETION_H_
