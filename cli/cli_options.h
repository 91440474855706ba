// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_CLI_OPTIONS_H_
#define RSSTAB_CLI_CLI_OPTIONS_H_

#include <string>
#include <variant>
#include <vector>

#include "cli/exit_codes.h"
#include "cli/invocation.h"

namespace rsstab::cli {

// A command line that asks for text (help, version) or cannot be understood.
struct EarlyExit {
  int exit_code = kExitDone;
  std::string output;  // for standard output
  std::string error;   // for standard error: one sentence and where to find help
};

// `arguments` without the program's name. A first argument that is a command's name is that
// command; a clip of such a name is reached as ./analyze. Values are checked; files are not looked
// at.
[[nodiscard]] std::variant<Invocation, EarlyExit> ParseCommandLine(
    const std::vector<std::string>& arguments);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_CLI_OPTIONS_H_
