// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/info.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/commands/info_analysis.h"
#include "cli/media/video_reader.h"
#include "cli/passes.h"
#include "cli/rs_inputs.h"
#include "stabilizer/pipeline/rs_source_selection.h"

namespace rsstab::cli {
namespace {

using Json = nlohmann::ordered_json;

// What the first pass would do, as far as can be told without looking at the pictures.
Result<std::string> Plan(const pipeline::StabilizeOptions& options, const media::VideoInfo& clip,
                         const pipeline::RsInputs& inputs, const Logger& logger) {
  if (pipeline::NeedsTracks(options, inputs)) {
    const bool may_use_log =
        options.rs == pipeline::RsChoice::kAuto || options.rs == pipeline::RsChoice::kGyro;
    return std::string(
        inputs.gyro && may_use_log
            ? "the gyro log would be brought into step with the picture and, if that can be "
              "trusted, tell the motion inside each frame"
        : pipeline::NeedsPictures(options, inputs)
            ? "the readout time would be found from the clip's tracks and from what single "
              "pictures of it show, the motion inside each frame from its tracks"
            : "the motion inside each frame, and the readout time if it is not given, would be "
              "found from the clip's tracks");
  }
  pipeline::ClipGeometry geometry{clip.width, clip.height};
  const auto selection = pipeline::SelectRsSource(options, geometry, inputs, {}, logger);
  if (!selection) {
    return Propagate(selection.error());
  }
  return selection->reason;
}

Json DescribeClip(const media::VideoInfo& clip) {
  Json json;
  json["path"] = clip.path;
  json["container"] = clip.container;
  json["codec"] = clip.codec;
  json["pixel_format"] = clip.pixel_format;
  json["width"] = clip.width;
  json["height"] = clip.height;
  json["frame_rate"] = clip.frame_rate.Value();
  json["variable_frame_rate"] = clip.variable_frame_rate;
  json["timestamps_repaired"] = clip.timestamps_repaired;
  json["frames"] = clip.frame_count;
  json["duration_s"] = clip.duration_s;
  json["rotation_degrees"] = clip.rotation_degrees;
  json["sample_aspect_ratio"] = clip.sample_aspect_ratio.Value();
  json["interlaced"] = clip.interlaced;
  json["color"] = {{"range", clip.color.range},
                   {"primaries", clip.color.primaries},
                   {"transfer", clip.color.transfer},
                   {"matrix", clip.color.matrix},
                   {"chroma_location", clip.color.chroma_location}};
  json["hdr_metadata"] = clip.has_hdr_metadata;
  json["audio_streams"] = clip.audio_streams;
  json["subtitle_streams"] = clip.subtitle_streams;
  json["attachment_streams"] = clip.attachment_streams;
  json["chapters"] = clip.chapters;
  json["data_tracks"] = clip.telemetry_kinds;
  return json;
}

Json DescribeGyro(const pipeline::RsInputs& inputs) {
  if (!inputs.gyro) {
    return nullptr;
  }
  const igf::GyroLog& log = *inputs.gyro;
  Json json;
  json["origin"] = inputs.gyro_origin;
  json["samples"] = log.samples().size();
  json["rate_hz"] = log.mean_rate_hz();
  json["start_s"] = log.start_s();
  json["end_s"] = log.end_s();
  json["gaps"] = log.gaps().size();
  return json;
}

Json DescribeCamera(const pipeline::RsInputs& inputs, const pipeline::StabilizeOptions& options) {
  Json json;
  if (inputs.camera) {
    json["fx"] = inputs.camera->fx;
    json["fy"] = inputs.camera->fy;
    json["cx"] = inputs.camera->cx;
    json["cy"] = inputs.camera->cy;
    json["distortion_coefficients"] = inputs.camera->distortion.size();
  }
  if (options.focal_px) {
    json["fx"] = *options.focal_px;
  }
  const std::optional<double> readout_s = options.readout_s ? options.readout_s
                                          : inputs.camera && inputs.camera->readout_s
                                              ? inputs.camera->readout_s
                                              : inputs.readout_s;
  if (readout_s) {
    json["readout_ms"] = *readout_s * 1e3;
  }
  return json;
}

std::string Count(int number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

std::string ClipText(const media::VideoInfo& clip) {
  std::string text = fmt::format(
      "clip     {}\n         {} in {}, {}x{}, {}, {:.6g} frames/s{}, {} frames, {:.3f} s\n",
      clip.path, clip.codec, clip.container, clip.width, clip.height, clip.pixel_format,
      clip.frame_rate.Value(), clip.variable_frame_rate ? " (varying)" : "",
      clip.frame_count > 0 ? std::to_string(clip.frame_count) : "?", clip.duration_s);
  if (clip.timestamps_repaired) {
    text += "         its timestamps are damaged and would be repaired\n";
  }
  if (clip.rotation_degrees != 0.0) {
    text += fmt::format("         shown turned by {:.6g} degrees\n", clip.rotation_degrees);
  }
  text +=
      fmt::format("streams  {}, {}, {}", Count(clip.audio_streams, "audio track"),
                  Count(clip.subtitle_streams, "subtitle track"), Count(clip.chapters, "chapter"));
  for (const std::string& kind : clip.telemetry_kinds) {
    text += ", data '" + kind + "'";
  }
  return text + "\n";
}

std::string GyroText(const Json& gyro) {
  if (gyro.is_null()) {
    return "gyro     none found\n";
  }
  return fmt::format("gyro     {}\n         {} samples, {:.1f} Hz, {:.3f} to {:.3f} s, {} gaps\n",
                     gyro["origin"].get<std::string>(), gyro["samples"].get<std::size_t>(),
                     gyro["rate_hz"].get<double>(), gyro["start_s"].get<double>(),
                     gyro["end_s"].get<double>(), gyro["gaps"].get<std::size_t>());
}

std::string CameraText(const Json& camera) {
  std::string text = "camera   ";
  text += camera.contains("fx") ? fmt::format("focal length {:.1f} px", camera["fx"].get<double>())
                                : std::string("focal length not known");
  text += camera.contains("readout_ms")
              ? fmt::format(", readout {:.2f} ms", camera["readout_ms"].get<double>())
              : std::string(", readout not known");
  return text + "\n";
}

Status Print(const std::string& text) {
  if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
    return Fail(ErrorCode::kIo, "standard output cannot be written");
  }
  return {};
}

}  // namespace

Status RunInfo(const Invocation& invocation, const CommandContext& context) {
  if (IsAnalysisFile(invocation.input)) {
    const auto text = DescribeAnalysis(invocation.input, invocation.json);
    if (!text) {
      return Propagate(text.error());
    }
    return Print(*text);
  }
  const pipeline::StabilizeOptions& options = invocation.stabilize;
  const auto reader = OpenClip(invocation.input, options, context.logger);
  if (!reader) {
    return Propagate(reader.error());
  }
  const media::VideoInfo& clip = (*reader)->info();
  const auto inputs = ReadRsInputs(options, clip, context.logger);
  if (!inputs) {
    return Propagate(inputs.error());
  }
  const auto plan = Plan(options, clip, *inputs, context.logger);
  if (!plan) {
    return Propagate(plan.error());
  }

  const Json gyro = DescribeGyro(*inputs);
  const Json camera = DescribeCamera(*inputs, options);
  std::string text;
  if (invocation.json) {
    const Json all = {{"clip", DescribeClip(clip)},
                      {"gyro", gyro},
                      {"camera", camera},
                      {"rolling_shutter", *plan}};
    // Names in files need not be UTF-8; what is not is replaced.
    text = all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  } else {
    text = ClipText(clip) + GyroText(gyro) + CameraText(camera) +
           "plan     rolling shutter: " + *plan + "\n";
  }
  return Print(text);
}

}  // namespace rsstab::cli
