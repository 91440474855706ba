// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_SYNTHETIC_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_SYNTHETIC_H_

#include <string>
#include <vector>

#include "cli/commands/evaluate_options.h"
#include "cli/commands/evaluation_header.h"
#include "evaluation/score_summary.h"
#include "evaluation/skew_response.h"
#include "evaluation/synthetic_protocol.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

struct SyntheticReport {
  EvaluationHeader header;
  std::size_t photos = 0;
  std::vector<evaluation::SampleRecord> samples;
  std::vector<evaluation::GroupSummary> groups;
  evaluation::SkewResponse skew;  // of no photographs where it was not asked for
};

// The report as a table for people, as one JSON object (figures that do not exist are null) and as
// CSV with a head line, one line for each picture and method. All end with a line feed.
[[nodiscard]] std::string FormatText(const SyntheticReport& report);
[[nodiscard]] std::string FormatJson(const SyntheticReport& report);
[[nodiscard]] std::string FormatCsv(const SyntheticReport& report);

// Runs the protocol synthetic-val on the methods that `factory` makes and summarises. Photographs
// that cannot be used are named by a warning and left out.
// Errors: kInvalidArgument without a folder of photographs; those of the protocol.
[[nodiscard]] Result<SyntheticReport> EvaluateSynthetic(
    const EvaluateOptions& options, const evaluation::MethodFactory& factory, const Logger& logger,
    const evaluation::EvaluationProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_SYNTHETIC_H_
