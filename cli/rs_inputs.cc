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
#include "igf/gpmf_parser.h"
#include "igf/gyro_log_reader.h"
#include "stabilizer/pipeline/rs_input_files.h"

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

}  // namespace

Result<pipeline::RsInputs> ReadRsInputs(const pipeline::StabilizeOptions& options,
                                        const media::VideoInfo& clip, const Logger& logger) {
  auto inputs = pipeline::ReadCameraInput(options, clip.width, clip.height);
  if (!inputs) {
    return inputs;
  }
  if (options.rs == pipeline::RsChoice::kOff || options.rs == pipeline::RsChoice::kDiffusion) {
    return inputs;
  }

  const auto parse = pipeline::GyroParseOptionsFrom(options);
  if (!parse) {
    return Propagate(parse.error());
  }

  const bool named = !options.gyro_file.empty();
  const bool has_track = std::find(clip.telemetry_kinds.begin(), clip.telemetry_kinds.end(),
                                   kGoProTrack) != clip.telemetry_kinds.end();
  if (!named && !has_track) {
    return inputs;
  }
  auto recording =
      named ? ReadNamedGyro(options.gyro_file, *parse) : ReadTelemetryGyro(clip.path, *parse);
  if (!recording) {
    if (named || options.rs == pipeline::RsChoice::kGyro) {
      return Propagate(recording.error());
    }
    logger->warn("the clip's telemetry is not used: {}", recording.error().message);
    return inputs;
  }
  inputs->gyro_shares_clock = !named;
  pipeline::AddGyro(std::move(*recording), named ? options.gyro_file : clip.path, logger, *inputs);
  return inputs;
}

}  // namespace rsstab::cli
