// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/option_table.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace rsstab::pipeline {
namespace {

template <typename Number>
std::optional<Number> ParseWhole(const std::string& text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

std::optional<double> ParseReal(const std::string& text) {
  const std::optional<double> value = ParseWhole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> ParseInteger(const std::string& text) {
  return ParseWhole<std::int64_t>(text);
}

std::optional<bool> ParseSwitch(const std::string& text) {
  if (text == "true" || text == "1") {
    return true;
  }
  if (text == "false" || text == "0") {
    return false;
  }
  return std::nullopt;
}

// Twelve digits: enough for any setting, and 16 ms stored as 0.016 s is printed as 16 again.
std::string FormatReal(double value) { return fmt::format("{:.12g}", value); }

std::string RealRange::Text() const {
  const bool from = std::isfinite(min);
  const bool to = std::isfinite(max);
  if (from && to) {
    return fmt::format("{} to {}", FormatReal(min), FormatReal(max));
  }
  if (from) {
    return FormatReal(min) + " or more";
  }
  return to ? FormatReal(max) + " or less" : std::string();
}

tl::unexpected<Error> BadOption(const std::string& name, const std::string& text,
                                const std::string& rule) {
  return Fail(ErrorCode::kInvalidArgument, "--{}: '{}' is not {}", name, text, rule);
}

}  // namespace rsstab::pipeline
