// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/analysis_path.h"

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace rsstab::frei0r {
namespace {

bool Exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

}  // namespace

std::string DecodePercent(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char code = 0;
    if (text[i] == '%' && i + 2 < text.size()) {
      const char* digits = text.data() + i + 1;
      const auto [end, error] = std::from_chars(digits, digits + 2, code, 16);
      if (error == std::errc() && end == digits + 2 && code != 0) {
        decoded += static_cast<char>(code);
        i += 2;
        continue;
      }
    }
    decoded += text[i];
  }
  return decoded;
}

std::string AnalysisPath(const std::string& parameter) {
  if (parameter.empty()) {
    const char* variable = std::getenv(kAnalysisVariable);  // NOLINT(concurrency-mt-unsafe)
    return variable == nullptr ? "" : variable;
  }
  if (!Exists(parameter)) {
    std::string decoded = DecodePercent(parameter);
    if (Exists(decoded)) {
      return decoded;
    }
  }
  return parameter;
}

}  // namespace rsstab::frei0r
