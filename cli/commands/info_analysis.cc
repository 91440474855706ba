// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/info_analysis.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "stabilizer/analysis_file.h"

namespace rsstab::cli {
namespace {

using Json = nlohmann::ordered_json;
using stabilizer::ClipAnalysis;

Json ToJson(const std::string& path, const ClipAnalysis& clip) {
  Json json;
  json["analysis"] = path;
  json["program_version"] = clip.program_version;
  json["width"] = clip.width;
  json["height"] = clip.height;
  json["frame_rate"] = clip.frames_per_second;
  json["frames"] = clip.num_frames;
  json["rs_source"] = clip.rs_source;
  json["rolling_shutter"] = clip.rs_reason;
  json["shutter"] = clip.shutter;
  json["readout_s"] = clip.readout_s;
  json["readout_sigma_s"] = clip.readout_sigma_s;
  json["focal_px"] = clip.focal_px;
  json["focal_sigma_px"] = clip.focal_sigma_px;
  json["focal_trusted"] = clip.focal_trusted;
  json["rotation_is_known"] = clip.rotation_is_known;
  json["gyro_offset_s"] = clip.gyro_offset_s ? Json(*clip.gyro_offset_s) : Json(nullptr);
  json["smallest_kept_ratio"] = clip.smallest_kept_ratio;
  json["mean_kept_ratio"] = clip.mean_kept_ratio;
  json["options"] = clip.options;
  return json;
}

std::string WithSigma(double value, double sigma, const char* unit) {
  return sigma > 0.0 ? fmt::format("{:.2f} +- {:.2f} {}", value, sigma, unit)
                     : fmt::format("{:.2f} {}", value, unit);
}

std::string ToText(const std::string& path, const ClipAnalysis& clip) {
  std::string text = fmt::format(
      "analysis {}\n         of {} frames, {}x{}, {:.6g} frames/s, by rs-stabilize {}\n"
      "rolling  {}\n",
      path, clip.num_frames, clip.width, clip.height, clip.frames_per_second, clip.program_version,
      clip.rs_reason);
  if (!clip.shutter.empty()) {
    text += fmt::format("shutter  {}, readout {}\n", clip.shutter,
                        WithSigma(clip.readout_s * 1e3, clip.readout_sigma_s * 1e3, "ms"));
    text += fmt::format("camera   focal length {}{}; its rotation {}\n",
                        WithSigma(clip.focal_px, clip.focal_sigma_px, "px"),
                        clip.focal_trusted ? "" : " (assumed)",
                        clip.rotation_is_known ? "explains the motion" : "is not all that moves");
  }
  return text + fmt::format("crop     {:.1f} % of each side kept, at least {:.1f} %\n",
                            100.0 * clip.mean_kept_ratio, 100.0 * clip.smallest_kept_ratio);
}

}  // namespace

bool IsAnalysisFile(const std::string& path) {
  std::array<char, 8> head{};
  std::ifstream file(path, std::ios::binary);
  return file.read(head.data(), head.size()) &&
         std::string_view(head.data(), head.size()) == "RSSTABAN";
}

Result<std::string> DescribeAnalysis(const std::string& path, bool as_json) {
  const auto reader = stabilizer::AnalysisReader::Open(path);
  if (!reader) {
    return Propagate(reader.error());
  }
  const ClipAnalysis& clip = (*reader)->clip();
  return as_json ? ToJson(path, clip).dump(2, ' ', false, Json::error_handler_t::replace) + "\n"
                 : ToText(path, clip);
}

}  // namespace rsstab::cli
