// SPDX-License-Identifier: Apache-2.0
#include "igf/gyroflow_json_parser.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "igf/base/json_fields_detail.h"

namespace rsstab::igf {

Result<GyroRecording> ParseGyroflowJson(std::string_view text, const GyroParseOptions& options) {
  const Result<nlohmann::json> root = ParseJsonObject(text);
  if (!root) {
    return Propagate(root.error());
  }
  const nlohmann::json* imu = FindField(*root, "raw_imu");
  if (imu == nullptr || !imu->is_array()) {
    return Fail(ErrorCode::kUnsupported,
                "the JSON file has no \"raw_imu\" rows; from the present Gyroflow, export the "
                "motion data as .gcsv or CSV instead");
  }
  const Eigen::Matrix3d camera_from_sensor = options.camera_from_sensor.value_or(
      Eigen::Matrix3d(Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal()));
  std::vector<GyroSample> samples;
  samples.reserve(imu->size());
  for (const nlohmann::json& row : *imu) {
    constexpr std::size_t kColumns = 4;
    const bool is_whole = row.is_array() && row.size() >= kColumns &&
                          std::all_of(row.begin(), row.begin() + kColumns,
                                      [](const nlohmann::json& v) { return v.is_number(); });
    if (!is_whole) {
      return Fail(ErrorCode::kCorruptData, "raw_imu, row {}: not at least four numbers t, x, y, z",
                  samples.size());
    }
    samples.push_back(
        {row[0].get<double>(),
         camera_from_sensor *
             Eigen::Vector3d(row[1].get<double>(), row[2].get<double>(), row[3].get<double>())});
  }
  Result<GyroLog> log = GyroLog::Create(std::move(samples), options.limits);
  if (!log) {
    return Propagate(std::move(log).error(), "raw_imu");
  }
  return GyroRecording{*std::move(log), "gyroflow", {}, std::nullopt, {}};
}

}  // namespace rsstab::igf
