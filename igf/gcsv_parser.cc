// SPDX-License-Identifier: Apache-2.0
#include "igf/gcsv_parser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "igf/gyro_text_rows.h"
#include "igf/imu_axes.h"

namespace rsstab::igf {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view kDefaultOrientation = "xzY";  // what Gyroflow takes
constexpr double kDefaultTimeScale = 1e-3;
constexpr double kMaxReadout_ms = 1000.0;

struct HeaderValue {
  std::size_t line = 0;
  std::string text;
};
using Header = std::map<std::string, HeaderValue>;

std::string TextOf(const Header& header, const std::string& key) {
  const auto found = header.find(key);
  return found == header.end() ? std::string() : found->second.text;
}

Result<double> ScaleOf(const Header& header, const std::string& key, double fallback) {
  const auto found = header.find(key);
  if (found == header.end() || found->second.text.empty()) {
    return fallback;
  }
  const std::optional<double> scale = ParseNumber(found->second.text);
  if (!scale || !std::isfinite(*scale) || *scale == 0.0) {
    return Fail(ErrorCode::kCorruptData, "line {}: {} is {}, which is no scale", found->second.line,
                key, Quoted(found->second.text));
  }
  return *scale;
}

// Signed readout in seconds; empty, with a note, where it does not run along the rows.
std::optional<double> ReadoutOf(const Header& header, std::vector<std::string>* notes) {
  const std::optional<double> readout_ms = ParseNumber(TextOf(header, "frame_readout_time"));
  if (!readout_ms || !(std::abs(*readout_ms) <= kMaxReadout_ms)) {
    return std::nullopt;
  }
  const std::string direction = ToLower(TextOf(header, "frame_readout_direction"));
  if (direction.empty() || direction == "0" || direction == "toptobottom") {
    return *readout_ms * 1e-3;
  }
  if (direction == "1" || direction == "180" || direction == "bottomtotop") {
    return -*readout_ms * 1e-3;
  }
  notes->push_back("the log says that the sensor is read out by columns, which is not supported");
  return std::nullopt;
}

Result<GyroColumns> FindColumns(const TextRows::Row& names) {
  GyroColumns columns;
  constexpr std::array<std::string_view, 3> kNames = {"gx", "gy", "gz"};
  for (std::size_t axis = 0; axis < kNames.size(); ++axis) {
    const auto found =
        std::find_if(names.fields.begin(), names.fields.end(),
                     [&](std::string_view field) { return ToLower(field) == kNames[axis]; });
    if (found == names.fields.end()) {
      return Fail(ErrorCode::kCorruptData, "line {}: no column \"{}\" among the column names",
                  names.line, kNames[axis]);
    }
    columns.rate[axis] = static_cast<std::size_t>(found - names.fields.begin());
  }
  return columns;
}

}  // namespace

bool IsGcsv(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  return text.starts_with("GYROFLOW IMU LOG") || text.starts_with("CAMERA IMU LOG");
}

Result<GyroRecording> ParseGcsv(std::string_view text, const GyroParseOptions& options) {
  if (!IsGcsv(text)) {
    return Fail(ErrorCode::kCorruptData,
                "line 1 is not \"GYROFLOW IMU LOG\"; this is no .gcsv gyro log");
  }
  TextRows rows(text);
  std::optional<TextRows::Row> row = rows.Next();  // the title
  Header header;
  while ((row = rows.Next())) {
    const std::string key = ToLower(row->fields.front());
    if (key == "t" || key == "time") {
      break;
    }
    header[key] = {row->line, row->fields.size() > 1 ? std::string(row->fields[1]) : std::string()};
  }
  if (!row) {
    return Fail(ErrorCode::kCorruptData,
                "the .gcsv log has no line of column names (t,gx,gy,gz); it may be cut off");
  }

  Result<GyroColumns> columns = FindColumns(*row);
  if (!columns) {
    return Propagate(std::move(columns).error());
  }
  const Result<double> time_scale = ScaleOf(header, "tscale", kDefaultTimeScale);
  const Result<double> rate_scale = ScaleOf(header, "gscale", 1.0);
  if (!time_scale || !rate_scale) {
    return Propagate(!time_scale ? time_scale.error() : rate_scale.error());
  }
  columns->time_scale = *time_scale;
  columns->rate_scale.setConstant(*rate_scale);

  std::vector<std::string> notes;
  if (options.camera_from_sensor) {
    columns->camera_from_sensor = *options.camera_from_sensor;
  } else {
    std::string orientation = TextOf(header, "orientation");
    if (orientation.empty()) {
      orientation = kDefaultOrientation;
      notes.push_back(fmt::format(
          "the log does not say how its axes lie; orientation {} is assumed", orientation));
    }
    Result<Eigen::Matrix3d> axes = CameraFromGyroflowOrientation(orientation);
    if (!axes) {
      return Propagate(Error{ErrorCode::kCorruptData, axes.error().message},
                       fmt::format("line {}, orientation", header["orientation"].line));
    }
    columns->camera_from_sensor = *axes;
  }

  Result<GyroLog> log = ReadGyroRows(rows, *columns, options.limits, &notes);
  if (!log) {
    return Propagate(std::move(log).error());
  }
  std::string device = TextOf(header, "vendor");
  const std::string id = TextOf(header, "id");
  device += device.empty() || id.empty() ? id : " " + id;
  const std::optional<double> readout_s = ReadoutOf(header, &notes);
  return GyroRecording{*std::move(log), "gcsv", std::move(device), readout_s, std::move(notes)};
}

}  // namespace rsstab::igf
