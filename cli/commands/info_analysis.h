// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_INFO_ANALYSIS_H_
#define RSSTAB_CLI_COMMANDS_INFO_ANALYSIS_H_

#include <string>

#include "igf/base/result.h"

namespace rsstab::cli {

// The file begins as an analysis file does.
[[nodiscard]] bool IsAnalysisFile(const std::string& path);

// What an analysis file says of its clip, as text or as one JSON object; ends with a line feed.
// Errors: those of stabilizer::AnalysisReader::Open.
[[nodiscard]] Result<std::string> DescribeAnalysis(const std::string& path, bool as_json);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_INFO_ANALYSIS_H_
