// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_FREI0R_ANALYSIS_PATH_H_
#define RSSTAB_PLUGIN_FREI0R_ANALYSIS_PATH_H_

#include <string>
#include <string_view>

namespace rsstab::frei0r {

// Names the analysis file where no parameter does.
inline constexpr const char* kAnalysisVariable = "RSSTAB_ANALYSIS";

// `text` with %3A and the like turned into the characters they stand for; anything else stays.
[[nodiscard]] std::string DecodePercent(std::string_view text);

// The file to open: the parameter, and when it is empty the environment variable; empty for live
// mode. A parameter that names no file as it stands, but does once decoded, is taken decoded: host
// syntaxes give `:`, `|`, `'` and `\` meanings of their own.
[[nodiscard]] std::string AnalysisPath(const std::string& parameter);

}  // namespace rsstab::frei0r

#endif  // RSSTAB_PLUGIN_FREI0R_ANALYSIS_PATH_H_
