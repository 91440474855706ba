// SPDX-License-Identifier: Apache-2.0
#include "igf/csv_parser.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "igf/gyro_text_rows.h"

namespace rsstab::igf {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

struct Unit {
  std::string_view name;  // letters and digits only
  double scale;
};
constexpr std::array<Unit, 13> kTimeUnits = {{{"s", 1.0},
                                              {"sec", 1.0},
                                              {"second", 1.0},
                                              {"seconds", 1.0},
                                              {"ms", 1e-3},
                                              {"msec", 1e-3},
                                              {"milliseconds", 1e-3},
                                              {"us", 1e-6},
                                              {"usec", 1e-6},
                                              {"microseconds", 1e-6},
                                              {"ns", 1e-9},
                                              {"nsec", 1e-9},
                                              {"nanoseconds", 1e-9}}};
constexpr std::array<Unit, 7> kRateUnits = {{{"rads", 1.0},
                                             {"radps", 1.0},
                                             {"radsec", 1.0},
                                             {"dps", kRadPerDeg},
                                             {"degs", kRadPerDeg},
                                             {"degps", kRadPerDeg},
                                             {"mdps", 1e-3 * kRadPerDeg}}};
constexpr std::array<std::string_view, 5> kTimeNames = {"t", "time", "timestamp", "ts", "elapsed"};
constexpr std::array<std::string_view, 9> kRateNames = {
    "g", "w", "gyr", "gyro", "gyroscope", "omega", "rate", "angularvelocity", "rotationrate"};

std::string LettersAndDigits(std::string_view text) {
  std::string kept;
  std::copy_if(text.begin(), text.end(), std::back_inserter(kept),
               [](unsigned char c) { return std::isalnum(c) != 0; });
  return kept;
}

// Lower case, with the signs of units that are not ASCII spelled out: a dropped "u" would turn
// microseconds into seconds.
std::string Normalise(std::string_view column) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kSigns = {
      {{"\xc2\xb5", "u"}, {"\xce\xbc", "u"}, {"\xc2\xb0", "deg"}}};
  std::string text = ToLower(column);
  for (const auto& [sign, letters] : kSigns) {
    for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign)) {
      text.replace(at, sign.size(), letters);
    }
  }
  return text;
}

// Splits a column's name into what it is and its unit, at every place where a unit could begin.
// `accept(name, unit)` says whether the pair makes sense.
template <typename Accept>
bool SplitUnit(const std::string& column, const Accept& accept) {
  if (accept(LettersAndDigits(column), std::string())) {
    return true;
  }
  for (std::size_t i = 1; i < column.size(); ++i) {
    const bool is_border = std::isalnum(static_cast<unsigned char>(column[i])) == 0;
    if (is_border &&
        accept(LettersAndDigits(column.substr(0, i)), LettersAndDigits(column.substr(i + 1)))) {
      return true;
    }
  }
  return false;
}

template <std::size_t N>
std::optional<double> ScaleOf(const std::string& unit, const std::array<Unit, N>& units) {
  if (unit.empty()) {
    return 1.0;
  }
  const auto found =
      std::find_if(units.begin(), units.end(), [&](const Unit& u) { return u.name == unit; });
  return found == units.end() ? std::nullopt : std::optional(found->scale);
}

Result<GyroColumns> FindColumns(const TextRows::Row& header) {
  GyroColumns columns;
  std::array<bool, 4> found = {};
  const auto claim = [&](std::size_t which, std::size_t column, std::size_t* place) {
    if (!found[which]) {  // of several, the first
      found[which] = true;
      *place = column;
      return true;
    }
    return false;
  };
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    SplitUnit(Normalise(header.fields[i]), [&](const std::string& name, const std::string& unit) {
      if (std::find(kTimeNames.begin(), kTimeNames.end(), name) != kTimeNames.end()) {
        const std::optional<double> scale = ScaleOf(unit, kTimeUnits);
        if (scale && claim(0, i, &columns.time)) {
          columns.time_scale = *scale;
        }
        return scale.has_value();
      }
      if (name.size() < 2 || name.back() < 'x' || name.back() > 'z' ||
          std::find(kRateNames.begin(), kRateNames.end(), name.substr(0, name.size() - 1)) ==
              kRateNames.end()) {
        return false;
      }
      const auto axis = static_cast<std::size_t>(name.back() - 'x');
      const std::optional<double> scale = ScaleOf(unit, kRateUnits);
      if (scale && claim(1 + axis, i, &columns.rate[axis])) {
        columns.rate_scale(static_cast<Eigen::Index>(axis)) = *scale;
      }
      return scale.has_value();
    });
  }
  constexpr std::array<std::string_view, 4> kNames = {"t", "gx", "gy", "gz"};
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) {
      return Fail(ErrorCode::kCorruptData,
                  "line {}: no column \"{}\" in the header; a gyro CSV begins with a line such as "
                  "t,gx,gy,gz (s, rad/s)",
                  header.line, kNames[i]);
    }
  }
  return columns;
}

}  // namespace

Result<GyroRecording> ParseGyroCsv(std::string_view text, const GyroParseOptions& options) {
  TextRows rows(text);
  const std::optional<TextRows::Row> header = rows.Next();
  if (!header) {
    return Fail(ErrorCode::kCorruptData, "the gyro CSV holds no line of data");
  }
  Result<GyroColumns> columns = FindColumns(*header);
  if (!columns) {
    return Propagate(std::move(columns).error());
  }
  if (options.camera_from_sensor) {
    columns->camera_from_sensor = *options.camera_from_sensor;
  }
  std::vector<std::string> notes;
  Result<GyroLog> log = ReadGyroRows(rows, *columns, options.limits, &notes);
  if (!log) {
    return Propagate(std::move(log).error());
  }
  return GyroRecording{*std::move(log), "csv", {}, std::nullopt, std::move(notes)};
}

void WriteGyroCsv(const GyroLog& log, std::ostream& out) {
  out << "t,gx,gy,gz\n";
  for (const GyroSample& sample : log.samples()) {
    // The shortest text that reads back as the same number.
    out << fmt::format("{},{},{},{}\n", sample.time_s, sample.rate_rad_s.x(), sample.rate_rad_s.y(),
                       sample.rate_rad_s.z());
  }
}

}  // namespace rsstab::igf
