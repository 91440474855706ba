// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluation_header.h"

namespace rsstab::cli {

EvaluationHeader MakeHeader(const EvaluateOptions& options,
                            std::vector<std::pair<std::string, Error>> failures) {
  EvaluationHeader header;
  for (const auto& spec : EvaluateOptionTable()) {
    if (const std::string value = spec.get(options); !value.empty()) {
      header.settings.push_back({spec.name, value, value == spec.get(EvaluateOptions())});
    }
  }
  header.failures = std::move(failures);
  return header;
}

void WarnOfFailures(const EvaluationHeader& header, const Logger& logger) {
  for (const auto& [name, error] : header.failures) {
    logger->warn("evaluate: {} is left out: {}", name, error.message);
  }
}

}  // namespace rsstab::cli
