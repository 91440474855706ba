// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_text_rows.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>

namespace rsstab::igf {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::size_t kLongestNumber = 64;

std::string_view Trim(std::string_view text, std::string_view unwanted) {
  const std::size_t begin = text.find_first_not_of(unwanted);
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(unwanted) - begin + 1);
}

bool IsComment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

}  // namespace

TextRows::TextRows(std::string_view text) : rest_(text) {
  if (rest_.starts_with(kByteOrderMark)) {
    rest_.remove_prefix(kByteOrderMark.size());
  }
}

std::optional<TextRows::Row> TextRows::Next() {
  while (!rest_.empty()) {
    const std::size_t newline = rest_.find('\n');
    const std::string_view line = Trim(rest_.substr(0, newline), " \t\r");
    rest_.remove_prefix(newline == std::string_view::npos ? rest_.size() : newline + 1);
    ++line_;
    if (line.empty() || IsComment(line)) {
      continue;
    }
    Row row;
    row.line = line_;
    row.is_last_and_open = newline == std::string_view::npos;
    char delimiter = ',';
    for (const char candidate : {'\t', ';'}) {
      delimiter = line.find(candidate) != std::string_view::npos ? candidate : delimiter;
    }
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(delimiter, begin), line.size());
      row.fields.push_back(Trim(line.substr(begin, end - begin), " \t\""));
      begin = end + 1;
    }
    return row;
  }
  return std::nullopt;
}

std::optional<double> ParseNumber(std::string_view field) {
  if (field.empty() || field.size() > kLongestNumber) {
    return std::nullopt;
  }
  std::string text(field.starts_with('+') ? field.substr(1) : field);
  if (text.find('.') == std::string::npos) {
    std::replace(text.begin(), text.end(), ',', '.');
  }
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) {
    return std::nullopt;
  }
  return number;
}

Result<GyroLog> ReadGyroRows(TextRows& rows, const GyroColumns& columns,
                             const GyroLogOptions& limits, std::vector<std::string>* notes) {
  const std::size_t last_column =
      std::max(columns.time, *std::max_element(columns.rate.begin(), columns.rate.end()));
  std::vector<GyroSample> samples;
  while (const std::optional<TextRows::Row> row = rows.Next()) {
    if (row->fields.size() <= last_column) {
      if (row->is_last_and_open && !samples.empty()) {
        notes->push_back(fmt::format("line {} breaks off and was left out", row->line));
        break;
      }
      return Fail(ErrorCode::kCorruptData, "line {} has {} columns, at least {} are needed",
                  row->line, row->fields.size(), last_column + 1);
    }
    const auto number = [&](std::size_t column) -> Result<double> {
      const std::optional<double> value = ParseNumber(row->fields[column]);
      if (!value || !std::isfinite(*value)) {
        return Fail(ErrorCode::kCorruptData, "line {}, column {}: {} is not a finite number",
                    row->line, column + 1, Quoted(row->fields[column]));
      }
      return *value;
    };
    GyroSample sample;
    const Result<double> time = number(columns.time);
    if (!time) {
      return Propagate(time.error());
    }
    sample.time_s = *time * columns.time_scale;
    Eigen::Vector3d stored;
    for (std::size_t i = 0; i < 3; ++i) {
      const Result<double> rate = number(columns.rate[i]);
      if (!rate) {
        return Propagate(rate.error());
      }
      stored(static_cast<Eigen::Index>(i)) = *rate;
    }
    sample.rate_rad_s = columns.camera_from_sensor * stored.cwiseProduct(columns.rate_scale);
    if (!samples.empty() && sample.time_s <= samples.back().time_s) {
      return Fail(ErrorCode::kCorruptData,
                  "line {}: time {} from {:.6f} s to {:.6f} s; rows must be in time order",
                  row->line, sample.time_s == samples.back().time_s ? "repeats" : "runs backwards",
                  samples.back().time_s, sample.time_s);
    }
    samples.push_back(sample);
  }
  return GyroLog::Create(std::move(samples), limits);
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kLongest = 32;
  std::string safe = "\"";
  for (const char c : text.substr(0, kLongest)) {
    safe += std::isprint(static_cast<unsigned char>(c)) != 0 ? c : '?';
  }
  return safe + (text.size() > kLongest ? "...\"" : "\"");
}

std::string ToLower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

}  // namespace rsstab::igf
