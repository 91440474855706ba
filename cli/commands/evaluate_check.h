// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_CHECK_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_CHECK_H_

#include <set>
#include <string>

#include "cli/commands/evaluate_options.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Whether the command line makes sense, before any file is looked at: one source of data, a
// protocol that goes with it, methods that are there. `given`: long names of the options that the
// user wrote. Errors: kInvalidArgument naming the option.
[[nodiscard]] Status Validate(const EvaluateOptions& options, const std::set<std::string>& given);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_CHECK_H_
