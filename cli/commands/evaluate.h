// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_H_

#include <ostream>
#include <string>
#include <vector>

#include "cli/commands/evaluate_options.h"
#include "cli/commands/evaluation_header.h"
#include "evaluation/image_pairs.h"
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

struct PairReport {
  EvaluationHeader header;
  std::vector<evaluation::PairRecord> pairs;
};

// The reports as a table for people, as one JSON object (figures that do not exist are null) and as
// CSV with a head line, one line for each picture and method. All end with a line feed.
[[nodiscard]] std::string FormatText(const SyntheticReport& report);
[[nodiscard]] std::string FormatJson(const SyntheticReport& report);
[[nodiscard]] std::string FormatCsv(const SyntheticReport& report);
[[nodiscard]] std::string FormatText(const PairReport& report);
[[nodiscard]] std::string FormatJson(const PairReport& report);
[[nodiscard]] std::string FormatCsv(const PairReport& report);

// Runs the protocol on the methods that `factory` makes and summarises. Photographs that cannot be
// used are named by a warning and left out.
// Errors: kInvalidArgument for a protocol without its folder; those of the protocol.
[[nodiscard]] Result<SyntheticReport> EvaluateSynthetic(
    const EvaluateOptions& options, const evaluation::MethodFactory& factory, const Logger& logger,
    const evaluation::EvaluationProgress& progress = {});
[[nodiscard]] Result<PairReport> EvaluatePairs(const EvaluateOptions& options,
                                               const evaluation::MethodFactory& factory,
                                               const Logger& logger,
                                               const evaluation::EvaluationProgress& progress = {});

// The methods that the options ask for.
// Errors: kInvalidArgument for an unknown method, or too few calibration samples; those of loading
// the models, which are tried once here.
[[nodiscard]] Result<evaluation::MethodFactory> MakeMethodFactory(const EvaluateOptions& options);

// All of it: table to `out`, CSV and JSON to their files.
[[nodiscard]] Status RunEvaluate(const EvaluateOptions& options, const Logger& logger,
                                 std::ostream& out,
                                 const evaluation::EvaluationProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_H_
