// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_report_detail.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace rsstab::cli::detail {

using evaluation::Interval;

Json OrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json ToJson(const Interval& interval) { return {OrNull(interval.low), OrNull(interval.high)}; }

std::string IntervalText(const Interval& interval, int digits) {
  return "[" + Cell(interval.low, 0, digits) + ", " + Cell(interval.high, 0, digits) + "]";
}

std::string Cell(double value, int width, int digits) {
  if (!std::isfinite(value)) {
    return fmt::format("{:>{}}", "-", width);
  }
  // What rounds to zero has no sign.
  const double shown = std::abs(value) < 0.5 * std::pow(10.0, -digits) ? 0.0 : value;
  return fmt::format("{:>{}.{}f}", shown, width, digits);
}

std::string HeaderText(const EvaluationHeader& header) {
  std::string text;
  for (const EvaluationSetting& setting : header.settings) {
    if (!setting.is_default || setting.name == "protocol" || setting.name == "seed") {
      text += (text.empty() ? "" : ", ") + setting.name + " " + setting.value;
    }
  }
  text += "\n";
  for (const auto& [name, error] : header.failures) {
    text += "left out: " + name + ": " + error.message + "\n";
  }
  return text;
}

Json HeaderJson(const EvaluationHeader& header) {
  Json json;
  json["settings"] = Json::object();
  for (const EvaluationSetting& setting : header.settings) {
    json["settings"][setting.name] = setting.value;
  }
  json["left_out"] = Json::array();
  for (const auto& [name, error] : header.failures) {
    json["left_out"].push_back({{"name", name}, {"reason", error.message}});
  }
  return json;
}

std::string Dump(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string Field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

}  // namespace rsstab::cli::detail
