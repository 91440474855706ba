// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_PAIRS_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_PAIRS_H_

#include <string>
#include <vector>

#include "cli/commands/evaluate_options.h"
#include "cli/commands/evaluation_header.h"
#include "evaluation/image_pairs.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

struct PairReport {
  EvaluationHeader header;
  std::vector<evaluation::PairRecord> pairs;
};

[[nodiscard]] std::string FormatText(const PairReport& report);
[[nodiscard]] std::string FormatJson(const PairReport& report);
[[nodiscard]] std::string FormatCsv(const PairReport& report);

[[nodiscard]] Result<PairReport> EvaluatePairs(const EvaluateOptions& options,
                                               const evaluation::MethodFactory& factory,
                                               const Logger& logger,
                                               const evaluation::EvaluationProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_PAIRS_H_
