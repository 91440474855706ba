// SPDX-License-Identifier: Apache-2.0
#include "cli/rs_inputs.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/media/telemetry_track.h"
#include "igf/camera_profile_reader.h"
#include "igf/gpmf_parser.h"
#include "igf/gyro_log_reader.h"
#include "igf/imu_axes.h"

namespace rsstab::cli {
namespace {

constexpr char kGoProTrack[] = "gpmd";

Result<igf::GyroRecording> ReadTelemetryGyro(const std::string& path,
                                             const igf::GyroParseOptions& options) {
  const auto payloads = media::ReadTelemetry(path, kGoProTrack);
  if (!payloads) {
    return Propagate(payloads.error());
  }
  std::vector<igf::GpmfPayload> views;
  for (const media::TelemetryPayload& payload : *payloads) {
    views.push_back({payload.bytes, payload.start_s, payload.duration_s});
  }
  auto recording = igf::ParseGpmf(views, options);
  if (!recording) {
    return Propagate(recording.error(), path);
  }
  return recording;
}

bool LooksLikeVideo(const std::string& path) {
  std::array<char, 4096> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(head.data()),
                        static_cast<std::size_t>(file.gcount()));
  return igf::RecogniseGyroFormat(bytes) == igf::GyroFormat::kVideo;
}

Result<igf::GyroRecording> ReadNamedGyro(const std::string& path,
                                         const igf::GyroParseOptions& options) {
  return LooksLikeVideo(path) ? ReadTelemetryGyro(path, options) : igf::ReadGyroLog(path, options);
}

Status ReadCamera(const pipeline::StabilizeOptions& options, const media::VideoInfo& clip,
                  pipeline::RsInputs& inputs) {
  const auto profile = igf::ReadCameraProfile(options.camera_file);
  if (!profile) {
    return Propagate(profile.error());
  }
  const auto fitted = igf::ProfileForVideo(*profile, clip.width, clip.height);
  if (!fitted) {
    return Propagate(fitted.error(), options.camera_file);
  }
  if (fitted->focal_is_known) {
    inputs.camera = fitted->camera;
  }
  inputs.readout_s = fitted->camera.readout_s;
  return {};
}

}  // namespace

Result<pipeline::RsInputs> ReadRsInputs(const pipeline::StabilizeOptions& options,
                                        const media::VideoInfo& clip, const Logger& logger) {
  pipeline::RsInputs inputs;
  if (!options.camera_file.empty()) {
    if (Status status = ReadCamera(options, clip, inputs); !status) {
      return Propagate(status.error());
    }
  }
  if (options.rs == pipeline::RsChoice::kOff || options.rs == pipeline::RsChoice::kDiffusion) {
    return inputs;
  }

  igf::GyroParseOptions parse;
  if (!options.gyro_axes.empty()) {
    const auto axes = igf::ParseAxisString(options.gyro_axes);
    if (!axes) {
      return Propagate(axes.error(), "--gyro-axes");
    }
    parse.camera_from_sensor = *axes;
  }

  const bool named = !options.gyro_file.empty();
  const bool has_track = std::find(clip.telemetry_kinds.begin(), clip.telemetry_kinds.end(),
                                   kGoProTrack) != clip.telemetry_kinds.end();
  if (!named && !has_track) {
    return inputs;
  }
  auto recording =
      named ? ReadNamedGyro(options.gyro_file, parse) : ReadTelemetryGyro(clip.path, parse);
  if (!recording) {
    if (named || options.rs == pipeline::RsChoice::kGyro) {
      return Propagate(recording.error());
    }
    logger->warn("the clip's telemetry is not used: {}", recording.error().message);
    return inputs;
  }
  inputs.gyro_origin = named ? options.gyro_file : clip.path;
  inputs.gyro_shares_clock = !named;
  for (const std::string& note : recording->notes) {
    logger->warn("{}: {}", inputs.gyro_origin, note);
  }
  if (!inputs.readout_s) {
    inputs.readout_s = recording->readout_s;
  }
  inputs.gyro = std::move(recording->gyro);
  return inputs;
}

}  // namespace rsstab::cli
