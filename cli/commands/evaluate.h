// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_H_

#include <functional>
#include <string>

#include "cli/commands/evaluate_options.h"
#include "evaluation/for_each_item.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// Prints the table of a report. Errors: kIo.
using EvaluationOutput = std::function<Status(const std::string& table)>;

// The protocol that the options name: table to `out`, then CSV, JSON and page to their files, which
// are opened before the work begins; what stopped runs go on from is removed when all is written.
// Each protocol has a file of its own beside this one. Errors: those of the protocol and of
// ReportFile.
[[nodiscard]] Status RunEvaluate(const EvaluateOptions& options, const Logger& logger,
                                 const EvaluationOutput& out,
                                 const evaluation::EvaluationProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_H_
