// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/stabilize_options.h"

#include <limits>
#include <utility>
#include <vector>

#include "rsdiff/backend/backend_options.h"

namespace rsstab::pipeline {
namespace {

using Spec = OptionSpec<StabilizeOptions>;
using stabilizer::Interpolation;

constexpr int kMaxMeshCells = 64;  // a side; finer cells hold too few tracks to mean anything
constexpr double kMaxZoom = 10.0;

std::vector<std::pair<std::string, std::string>> DeviceChoices() {
  std::vector<std::pair<std::string, std::string>> choices;
  for (const char* device : rsdiff::kDeviceNames) {
    choices.emplace_back(device, device);
  }
  return choices;
}

// "16x16" in two fields.
Spec MeshOption() {
  Spec spec;
  spec.name = "mesh";
  spec.value_name = "COLSxROWS";
  spec.range = fmt::format("1x1 to {0}x{0}", kMaxMeshCells);
  spec.set = [](StabilizeOptions& options, const std::string& text) -> Status {
    const std::size_t split = text.find('x');
    std::optional<std::int64_t> columns;
    std::optional<std::int64_t> rows;
    if (split != std::string::npos) {
      columns = ParseInteger(text.substr(0, split));
      rows = ParseInteger(text.substr(split + 1));
    }
    const auto allowed = [](const std::optional<std::int64_t>& cells) {
      return cells && *cells >= 1 && *cells <= kMaxMeshCells;
    };
    if (!allowed(columns) || !allowed(rows)) {
      return BadOption(
          "mesh", text,
          fmt::format("columns and rows from 1x1 to {0}x{0}, as in 16x16", kMaxMeshCells));
    }
    options.mesh_columns = static_cast<int>(*columns);
    options.mesh_rows = static_cast<int>(*rows);
    return {};
  };
  spec.get = [](const StabilizeOptions& options) {
    return fmt::format("{}x{}", options.mesh_columns, options.mesh_rows);
  };
  return spec;
}

// A mode, or a number that is the fixed zoom itself.
Spec ZoomOption() {
  Spec spec;
  spec.name = "zoom";
  spec.value_name = "adaptive|fixed|FACTOR";
  spec.range = fmt::format("FACTOR from 1 to {}", FormatReal(kMaxZoom));
  spec.set = [](StabilizeOptions& options, const std::string& text) -> Status {
    const std::optional<double> factor = ParseReal(text);
    if (text == "adaptive" || text == "fixed") {
      options.zoom = text == "fixed" ? ZoomMode::kFixed : ZoomMode::kAdaptive;
      options.fixed_zoom.reset();
    } else if (factor && *factor >= 1.0 && *factor <= kMaxZoom) {
      options.zoom = ZoomMode::kFixed;
      options.fixed_zoom = factor;
    } else {
      return BadOption("zoom", text,
                       fmt::format("adaptive, fixed or a factor from 1 to {}", kMaxZoom));
    }
    return {};
  };
  spec.get = [](const StabilizeOptions& options) -> std::string {
    if (options.zoom == ZoomMode::kAdaptive) {
      return "adaptive";
    }
    return options.fixed_zoom ? FormatReal(*options.fixed_zoom) : "fixed";
  };
  return spec;
}

OptionTable<StabilizeOptions> BuildTable() {
  OptionTable<StabilizeOptions> table;
  std::string group;
  const auto add = [&](Spec spec, OptionStage stage, std::string help) {
    spec.group = group;
    spec.stage = stage;
    spec.help = std::move(help);
    table.push_back(std::move(spec));
  };
  using O = StabilizeOptions;

  group = "Rolling shutter";
  add(ChoiceOption<O, RsChoice>("rs", &O::rs,
                                {{"auto", RsChoice::kAuto},
                                 {"fused", RsChoice::kFused},
                                 {"gyro", RsChoice::kGyro},
                                 {"diffusion", RsChoice::kDiffusion},
                                 {"tracks", RsChoice::kTracks},
                                 {"off", RsChoice::kOff}}),
      OptionStage::kAnalysis,
      "What tells the motion inside a frame: auto takes a gyro log when there is a trustworthy one "
      "and fused otherwise; fused finds one camera rotation and the readout time of the clip from "
      "its tracks and single pictures, and leaves a global shutter alone; gyro wants the log or "
      "fails; diffusion estimates each frame from its picture alone; tracks is fused without "
      "looking at single pictures; off never corrects.");
  add(TextOption("gyro", "FILE", &O::gyro_file), OptionStage::kAnalysis,
      "Gyro log: MP4/MOV with GoPro telemetry, .gcsv, or CSV with the header t,gx,gy,gz (s, "
      "rad/s). "
      "Without it the clip's own telemetry track is used.");
  add(TextOption("gyro-axes", "XYZ", &O::gyro_axes), OptionStage::kAnalysis,
      "Which sensor axes point along the camera's x (right), y (down), z (forward), lower case for "
      "the opposite way; for example yXZ. Only for logs that do not say it themselves.");
  add(RealOption("gyro-offset", "S", &O::gyro_offset_s, {-86400.0, 86400.0}),
      OptionStage::kAnalysis,
      "Seconds to add to the log's clock to get the clip's. Found from the picture when not "
      "given; --rs auto moves it by up to 0.02 where the picture leaves no doubt, --rs gyro keeps "
      "it.");
  add(RealOption("readout", "MS", &O::readout_s, {-1000.0, 1000.0}, 1e-3), OptionStage::kAnalysis,
      "Milliseconds from reading the first row of the sensor to the last; negative reads bottom to "
      "top, 0 is a global shutter. From the camera file or the log, or found, when not given.");
  add(RealOption("focal", "PX", &O::focal_px, {1.0, 1e6}), OptionStage::kAnalysis,
      "Focal length in pixels of the clip. From the camera file or the log, or found, when not "
      "given.");
  add(TextOption("camera", "FILE", &O::camera_file), OptionStage::kAnalysis,
      "Camera JSON (size, focal length, lens distortion, readout time) or a Gyroflow lens "
      "profile.");

  group = "Rolling shutter from pictures (--rs diffusion)";
  add(TextOption("model", "FILE", &O::model), OptionStage::kAnalysis,
      "Diffusion model: its JSON file, the folder of it, or the name of an installed one. Without "
      "it the installed compact model.");
  add(IntegerOption("samples", "N", &O::samples, 1, 1024), OptionStage::kAnalysis,
      "Motions drawn for each frame, of which the mean is taken.");
  add(IntegerOption("steps", "N", &O::sampling_steps, 0, 1000), OptionStage::kAnalysis,
      "Denoising steps of each draw; 0 takes what the model says.");
  add(RealOption("rs-strength", "SHARE", &O::rs_strength, {0.0, 2.0}), OptionStage::kAnalysis,
      "Share of the estimated motion that is corrected.");
  add(ChoiceOption<O, std::string>("device", &O::device, DeviceChoices()), OptionStage::kAnalysis,
      "Where the network runs; all but auto and cpu need an OpenCV (or libtorch) built for it.");

  group = "Stabilization";
  add(RealOption("smoothness", "S", &O::smoothness_s, {0.0, 10.0}), OptionStage::kAnalysis,
      "How calm the camera becomes: shake quicker than about this many seconds is taken out. 0 "
      "takes out rolling shutter only.");
  add(SwitchOption("tripod", &O::tripod), OptionStage::kAnalysis,
      "Hold the view still, as if the camera stood on a tripod (for clips that mean to).");
  add(RealOption("crop", "RATIO", &O::min_crop_ratio, {0.1, 1.0}), OptionStage::kAnalysis,
      "Smallest share of the picture's width and height that may be kept; the path is held closer "
      "to the camera's where it would need more.");
  add(ZoomOption(), OptionStage::kAnalysis,
      "How borders are hidden: adaptive zooms as much as each moment needs, fixed once for the "
      "whole clip, a factor is that fixed zoom itself.");
  add(MeshOption(), OptionStage::kAnalysis,
      "Cells over which the motion may differ; 1x1 moves the picture as a whole.");

  group = "Picture";
  add(ChoiceOption<O, Interpolation>("interpolation", &O::interpolation,
                                     {{"bilinear", Interpolation::kBilinear},
                                      {"bicubic", Interpolation::kBicubic},
                                      {"lanczos", Interpolation::kLanczos}}),
      OptionStage::kRender, "How pixels are resampled, from quickest to sharpest.");

  group = "Running";
  add(IntegerOption("threads", "N", &O::num_threads, 0, 1024), OptionStage::kBoth,
      "Threads to use; 0 takes one for each processor.");
  add(IntegerOption("seed", "N", &O::seed, 0, std::numeric_limits<std::int64_t>::max()),
      OptionStage::kAnalysis,
      "Where random choices start. The same seed and thread count give the same file.");
  return table;
}

}  // namespace

const OptionTable<StabilizeOptions>& StabilizeOptionTable() {
  static const OptionTable<StabilizeOptions> table = BuildTable();
  return table;
}

Status Validate(const StabilizeOptions& options) {
  if (Status status = ValidateOptions(StabilizeOptionTable(), options); !status) {
    return status;
  }
  if (options.rs == RsChoice::kOff && !options.gyro_file.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--rs off uses no gyro log, but --gyro {} was given; leave one of them out",
                options.gyro_file);
  }
  if (options.rs == RsChoice::kDiffusion && !options.gyro_file.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--rs diffusion looks at the pictures only, but --gyro {} was given; leave one of "
                "them out",
                options.gyro_file);
  }
  return {};
}

}  // namespace rsstab::pipeline
