// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_REPORT_DETAIL_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_REPORT_DETAIL_H_

#include <nlohmann/json.hpp>
#include <string>

#include "cli/commands/evaluation_header.h"
#include "evaluation/statistics.h"

// What the reports of all protocols are put together from. A figure that does not exist is NaN.
namespace rsstab::cli::detail {

using Json = nlohmann::ordered_json;

// The number right-aligned in `width` columns, "-" where there is none.
[[nodiscard]] std::string Cell(double value, int width, int digits);

// "[low, high]"
[[nodiscard]] std::string IntervalText(const evaluation::Interval& interval, int digits);

[[nodiscard]] Json OrNull(double value);
[[nodiscard]] Json ToJson(const evaluation::Interval& interval);

// One CSV field, quoted where it must be.
[[nodiscard]] std::string Field(const std::string& text);

// The settings that differ from their defaults, then a line for each thing left out.
[[nodiscard]] std::string HeaderText(const EvaluationHeader& header);

// "settings" and "left_out".
[[nodiscard]] Json HeaderJson(const EvaluationHeader& header);

// With a line feed; bytes that are no UTF-8 (paths need not be) are replaced.
[[nodiscard]] std::string Dump(const Json& json);

inline constexpr double kPercent = 100.0;

}  // namespace rsstab::cli::detail

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_REPORT_DETAIL_H_
