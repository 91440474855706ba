// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/analysis_format_detail.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace rsstab::stabilizer::detail {
namespace {

constexpr int kMaxGridSide = 512;
constexpr float kQuantizationSteps = 32767.0F;

constexpr std::uint16_t kOrientationPart = 1;
constexpr std::uint16_t kOrientationSize = 4 + 4 * 8;
// A unit quaternion in doubles is within 1e-15 of its length.
constexpr double kUnitTolerance = 1e-9;

// Empty when it is no rotation.
std::optional<FrameOrientation> GetOrientation(ByteSource& source) {
  FrameOrientation orientation;
  orientation.world = source.Get<std::uint32_t>();
  for (double& part : orientation.camera_from_world.coeffs()) {
    part = source.Get<double>();
  }
  // Not a number is not within.
  const double error = std::abs(orientation.camera_from_world.norm() - 1.0);
  return error <= kUnitTolerance ? std::optional(orientation) : std::nullopt;
}

}  // namespace

std::uint32_t Checksum(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(
      crc32(crc32(0L, Z_NULL, 0), bytes.data(), static_cast<uInt>(bytes.size())));
}

std::string LastError() { return std::strerror(errno); }

void PutField(ByteSink& sink, const MotionField& field) {
  sink.Put(static_cast<std::uint16_t>(field.columns()));
  sink.Put(static_cast<std::uint16_t>(field.rows()));
  if (field.columns() == 0) {
    return;
  }
  float largest = 0.0F;
  for (const Eigen::Vector2f& d : field.vertices()) {
    largest = std::max(largest, d.cwiseAbs().maxCoeff());
  }
  const float step = largest > 0.0F ? largest / kQuantizationSteps : 1.0F;
  sink.Put(step);
  sink.Put(static_cast<float>(field.reference_row()));
  for (const Eigen::Vector2f& d : field.vertices()) {
    sink.Put(static_cast<std::int16_t>(std::lround(d.x() / step)));
    sink.Put(static_cast<std::int16_t>(std::lround(d.y() / step)));
  }
}

// Empty when the bytes make no sense.
std::optional<MotionField> GetField(ByteSource& source, int width, int height) {
  const int columns = source.Get<std::uint16_t>();
  const int rows = source.Get<std::uint16_t>();
  if (columns == 0 && rows == 0) {
    return MotionField();
  }
  if (columns < 2 || rows < 2 || columns > kMaxGridSide || rows > kMaxGridSide) {
    return std::nullopt;
  }
  const auto step = source.Get<float>();
  const auto reference_row = source.Get<float>();
  const std::size_t needed = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) * 4;
  if (!std::isfinite(step) || !std::isfinite(reference_row) || source.remaining() < needed) {
    return std::nullopt;
  }
  MotionField field(width, height, columns, rows);
  field.set_reference_row(static_cast<double>(reference_row));
  for (Eigen::Vector2f& d : field.vertices()) {
    const float x = static_cast<float>(source.Get<std::int16_t>()) * step;
    const float y = static_cast<float>(source.Get<std::int16_t>()) * step;
    d = {x, y};
  }
  return field;
}

void PutOptionalParts(ByteSink& sink, const FrameAnalysis& frame) {
  if (!frame.orientation) {
    return;
  }
  sink.Put(kOrientationPart);
  sink.Put(kOrientationSize);
  sink.Put(frame.orientation->world);
  const Eigen::Quaterniond camera_from_world = frame.orientation->camera_from_world.normalized();
  for (const double part : camera_from_world.coeffs()) {
    sink.Put(part);
  }
}

bool GetOptionalParts(ByteSource& source, FrameAnalysis& frame) {
  while (source.remaining() > 0) {
    const auto kind = source.Get<std::uint16_t>();
    const auto size = source.Get<std::uint16_t>();
    if (!source.ok() || size > source.remaining()) {
      return false;
    }
    if (kind != kOrientationPart) {
      source.Skip(size);
      continue;
    }
    if (size != kOrientationSize || frame.orientation) {
      return false;
    }
    frame.orientation = GetOrientation(source);
    if (!frame.orientation) {
      return false;
    }
  }
  return true;
}

nlohmann::json ToJson(const ClipAnalysis& clip) {
  nlohmann::json json = {{"program_version", clip.program_version},
                         {"width", clip.width},
                         {"height", clip.height},
                         {"frames_per_second", clip.frames_per_second},
                         {"seconds_per_tick", clip.seconds_per_tick},
                         {"num_frames", clip.num_frames},
                         {"smallest_crop_ratio", clip.smallest_crop_ratio},
                         {"fixed_zoom", clip.fixed_zoom},
                         {"smallest_kept_ratio", clip.smallest_kept_ratio},
                         {"mean_kept_ratio", clip.mean_kept_ratio},
                         {"rs_source", clip.rs_source},
                         {"rs_reason", clip.rs_reason},
                         {"readout_s", clip.readout_s},
                         {"readout_sigma_s", clip.readout_sigma_s},
                         {"shutter", clip.shutter},
                         {"focal_px", clip.focal_px},
                         {"focal_sigma_px", clip.focal_sigma_px},
                         {"focal_trusted", clip.focal_trusted},
                         {"rotation_is_known", clip.rotation_is_known},
                         {"options", clip.options}};
  if (clip.gyro_offset_s) {
    json["gyro_offset_s"] = *clip.gyro_offset_s;
  }
  if (clip.camera) {
    const Camera& c = *clip.camera;
    json["camera"] = {{"fx", c.fx},
                      {"fy", c.fy},
                      {"cx", c.cx},
                      {"cy", c.cy},
                      {"model", static_cast<int>(c.model)},
                      {"distortion", c.distortion}};
  }
  return json;
}

ClipAnalysis FromJson(const nlohmann::json& json) {
  ClipAnalysis clip;
  clip.program_version = json.at("program_version").get<std::string>();
  clip.width = json.at("width").get<int>();
  clip.height = json.at("height").get<int>();
  clip.frames_per_second = json.at("frames_per_second").get<double>();
  clip.seconds_per_tick = json.value("seconds_per_tick", 0.0);
  clip.num_frames = json.at("num_frames").get<std::int64_t>();
  clip.smallest_crop_ratio = json.at("smallest_crop_ratio").get<double>();
  clip.fixed_zoom = json.at("fixed_zoom").get<bool>();
  clip.smallest_kept_ratio = json.at("smallest_kept_ratio").get<double>();
  clip.mean_kept_ratio = json.at("mean_kept_ratio").get<double>();
  clip.rs_source = json.at("rs_source").get<std::string>();
  clip.rs_reason = json.at("rs_reason").get<std::string>();
  clip.readout_s = json.at("readout_s").get<double>();
  // Written since the clip's own motion can tell.
  clip.readout_sigma_s = json.value("readout_sigma_s", 0.0);
  clip.shutter = json.value("shutter", std::string());
  clip.focal_px = json.value("focal_px", 0.0);
  clip.focal_sigma_px = json.value("focal_sigma_px", 0.0);
  clip.focal_trusted = json.value("focal_trusted", false);
  clip.rotation_is_known = json.value("rotation_is_known", false);
  clip.options = json.at("options").get<std::string>();
  if (json.contains("gyro_offset_s")) {
    clip.gyro_offset_s = json.at("gyro_offset_s").get<double>();
  }
  if (json.contains("camera")) {
    const auto& c = json.at("camera");
    Camera camera;
    camera.width = clip.width;
    camera.height = clip.height;
    camera.fx = c.at("fx").get<double>();
    camera.fy = c.at("fy").get<double>();
    camera.cx = c.at("cx").get<double>();
    camera.cy = c.at("cy").get<double>();
    camera.model = static_cast<LensModel>(std::clamp(c.at("model").get<int>(), 0, 2));
    camera.distortion = c.at("distortion").get<std::vector<double>>();
    clip.camera = camera;
  }
  return clip;
}

}  // namespace rsstab::stabilizer::detail
