// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_H_

#include <ostream>

#include "cli/commands/evaluate_options.h"
#include "evaluation/for_each_item.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// The protocol that the options name: table to `out`, CSV and JSON to their files. Each protocol
// has a file of its own beside this one.
[[nodiscard]] Status RunEvaluate(const EvaluateOptions& options, const Logger& logger,
                                 std::ostream& out,
                                 const evaluation::EvaluationProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_H_
