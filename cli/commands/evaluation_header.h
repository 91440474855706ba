// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATION_HEADER_H_
#define RSSTAB_CLI_COMMANDS_EVALUATION_HEADER_H_

#include <string>
#include <utility>
#include <vector>

#include "cli/commands/evaluate_options.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

struct EvaluationSetting {
  std::string name;  // of the option, without dashes
  std::string value;
  bool is_default = true;
};

// What a report says beside its figures.
struct EvaluationHeader {
  std::vector<EvaluationSetting> settings;
  std::vector<std::pair<std::string, Error>> failures;  // what was left out, and why
};

[[nodiscard]] EvaluationHeader MakeHeader(const EvaluateOptions& options,
                                          std::vector<std::pair<std::string, Error>> failures);

// One warning for each thing left out.
void WarnOfFailures(const EvaluationHeader& header, const Logger& logger);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATION_HEADER_H_
