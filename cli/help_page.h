// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_HELP_PAGE_H_
#define RSSTAB_CLI_HELP_PAGE_H_

#include <string>

#include "cli/invocation.h"

namespace rsstab::cli {

// What --help prints for a command: usage, options under their headings, examples; lines of at most
// 80 columns.
[[nodiscard]] std::string HelpPage(CommandId id);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_HELP_PAGE_H_
