// SPDX-License-Identifier: Apache-2.0
#include "igf/simulation_truth.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "igf/base/whole_file.h"
#include "igf/camera_profile_reader.h"

namespace rsstab::igf {
namespace {

using nlohmann::json;

constexpr std::string_view kFormat = "rs-stabilize truth";
constexpr int kVersion = 1;

json QuaternionToJson(const Eigen::Quaterniond& q) {
  return json::array({q.x(), q.y(), q.z(), q.w()});
}

Eigen::Quaterniond QuaternionFromJson(const json& value) {
  return {value.at(3).get<double>(), value.at(0).get<double>(), value.at(1).get<double>(),
          value.at(2).get<double>()};
}

// Indices [first, last] of the samples that hold [begin_s, end_s] between them.
std::pair<std::size_t, std::size_t> SamplesAround(const OrientationTrack& track, double begin_s,
                                                  double end_s) {
  std::size_t first = 0;
  std::size_t last = track.num_samples() - 1;
  while (first + 1 < last && track.SampleTime(first + 1) <= begin_s) {
    ++first;
  }
  while (last > first + 1 && track.SampleTime(last - 1) > end_s) {
    --last;
  }
  return {first, last};
}

}  // namespace

Result<std::string> FormatSimulationTruth(const SimulationTruth& truth, double margin_s) {
  const OrientationTrack& track = truth.orientation;
  const double readout_s = truth.camera.readout_s.value_or(0.0);
  const double half_span = (std::abs(readout_s) + truth.exposure_s) / 2.0;
  if (truth.frame_times_s.empty() || !track.Covers(truth.frame_times_s.front() - half_span,
                                                   truth.frame_times_s.back() + half_span)) {
    return Fail(ErrorCode::kInvalidArgument,
                "The true motion must cover the {} frames of the clip.",
                truth.frame_times_s.size());
  }
  Camera camera = truth.camera;
  camera.readout_s = readout_s;
  json document = {{"format", kFormat},
                   {"version", kVersion},
                   {"camera", json::parse(FormatCameraJson(camera))},
                   {"exposure_s", truth.exposure_s},
                   {"gyro_offset_s", truth.gyro_offset_s}};
  json& frames = document["frames"] = json::array();
  for (std::size_t n = 0; n < truth.frame_times_s.size(); ++n) {
    const double time_s = truth.frame_times_s[n];
    const std::optional<Eigen::Quaterniond> camera_from_world = track.CameraFromWorld(time_s);
    if (!camera_from_world) {
      return Fail(ErrorCode::kInvalidArgument, "The true motion has a hole at frame {} ({} s).", n,
                  time_s);
    }
    frames.push_back({{"index", n},
                      {"time_s", time_s},
                      {"world_from_camera", QuaternionToJson(camera_from_world->conjugate())}});
  }
  const auto [first, last] =
      SamplesAround(track, truth.frame_times_s.front() - half_span - margin_s,
                    truth.frame_times_s.back() + half_span + margin_s);
  json times = json::array();
  json orientations = json::array();
  for (std::size_t i = first; i <= last; ++i) {
    times.push_back(track.SampleTime(i));
    orientations.push_back(QuaternionToJson(track.SampleWorldFromCamera(i)));
  }
  document["orientation"] = {{"times_s", std::move(times)},
                             {"world_from_camera", std::move(orientations)}};
  return document.dump() + "\n";
}

Result<SimulationTruth> ParseSimulationTruth(const std::string& text) {
  try {
    const json document = json::parse(text);
    if (document.at("format").get<std::string>() != kFormat ||
        document.at("version").get<int>() != kVersion) {
      return Fail(ErrorCode::kUnsupported,
                  "The file is not a truth file of version {}; make it anew with `rs-stabilize "
                  "simulate`.",
                  kVersion);
    }
    const Result<CameraProfile> profile = ParseCameraJson(document.at("camera").dump());
    if (!profile) {
      return Propagate(profile.error(), "The truth file's camera");
    }
    const json& orientation = document.at("orientation");
    std::vector<Eigen::Quaterniond> samples;
    for (const json& value : orientation.at("world_from_camera")) {
      samples.push_back(QuaternionFromJson(value));
    }
    Result<OrientationTrack> track = OrientationTrack::Create(
        orientation.at("times_s").get<std::vector<double>>(), std::move(samples));
    if (!track) {
      return Fail(ErrorCode::kCorruptData, "The truth file's orientation: {}",
                  track.error().message);
    }
    SimulationTruth truth{profile->camera,
                          document.at("exposure_s").get<double>(),
                          document.at("gyro_offset_s").get<double>(),
                          {},
                          *std::move(track)};
    for (const json& frame : document.at("frames")) {
      truth.frame_times_s.push_back(frame.at("time_s").get<double>());
    }
    return truth;
  } catch (const json::exception& error) {
    return Fail(ErrorCode::kCorruptData,
                "The truth file cannot be read ({}); make it anew with `rs-stabilize simulate`.",
                error.what());
  }
}

Result<SimulationTruth> ReadSimulationTruth(const std::string& path) {
  constexpr std::uint64_t kMaxBytes = 1ULL << 30U;
  const Result<std::string> text = ReadWholeFile(path, kMaxBytes);
  if (!text) {
    return Propagate(text.error());
  }
  Result<SimulationTruth> truth = ParseSimulationTruth(*text);
  if (!truth) {
    return Propagate(truth.error(), path);
  }
  return truth;
}

}  // namespace rsstab::igf
