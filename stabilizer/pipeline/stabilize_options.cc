// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/stabilize_options.h"

#include <limits>

#include "stabilizer/pipeline/shared_options.h"

namespace rsstab::pipeline {
namespace {

using Spec = OptionSpec<StabilizeOptions>;

constexpr int kMaxMeshCells = 64;  // a side; finer cells hold too few tracks to mean anything
constexpr double kMaxZoom = 10.0;

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
  OptionTableBuilder<StabilizeOptions> table;
  using O = StabilizeOptions;

  table.Group("Rolling shutter", OptionStage::kAnalysis);
  table.Add(
      ChoiceOption<O, RsChoice>("rs", &O::rs,
                                {{"auto", RsChoice::kAuto},
                                 {"fused", RsChoice::kFused},
                                 {"gyro", RsChoice::kGyro},
                                 {"diffusion", RsChoice::kDiffusion},
                                 {"tracks", RsChoice::kTracks},
                                 {"off", RsChoice::kOff}}),
      "What tells the motion inside a frame: auto takes a gyro log when there is a trustworthy one "
      "and fused otherwise; fused finds one camera rotation and the readout time of the clip from "
      "its tracks and single pictures, and leaves a global shutter alone; gyro wants the log or "
      "fails; diffusion estimates each frame from its picture alone; tracks is fused without "
      "looking at single pictures; off never corrects.");
  table.Add(TextOption("gyro", "FILE", &O::gyro_file),
            "Gyro log: MP4/MOV with GoPro telemetry, .gcsv, or CSV with the header t,gx,gy,gz (s, "
            "rad/s). "
            "Without it the clip's own telemetry track is used.");
  table.Add(
      TextOption("gyro-axes", "XYZ", &O::gyro_axes),
      "Which sensor axes point along the camera's x (right), y (down), z (forward), lower case for "
      "the opposite way; for example yXZ. Only for logs that do not say it themselves.");
  table.Add(
      RealOption("gyro-offset", "S", &O::gyro_offset_s, {-86400.0, 86400.0}),
      "Seconds to add to the log's clock to get the clip's. Found from the picture when not "
      "given; --rs auto moves it by up to 0.02 where the picture leaves no doubt, --rs gyro keeps "
      "it.");
  table.Add(
      RealOption("readout", "MS", &O::readout_s, {-1000.0, 1000.0}, 1e-3),
      "Milliseconds from reading the first row of the sensor to the last; negative reads bottom to "
      "top, 0 is a global shutter. From the camera file or the log, or found, when not given.");
  table.Add(
      RealOption("focal", "PX", &O::focal_px, {1.0, 1e6}),
      "Focal length in pixels of the clip. From the camera file or the log, or found, when not "
      "given.");
  table.Add(TextOption("camera", "FILE", &O::camera_file),
            "Camera JSON (size, focal length, lens distortion, readout time) or a Gyroflow lens "
            "profile.");

  table.Group("Rolling shutter from pictures (--rs diffusion)", OptionStage::kAnalysis);
  table.Add(ModelOption(&O::model));
  table.Add(IntegerOption("samples", "N", &O::samples, 1, 1024),
            "Motions drawn for each frame, of which the mean is taken.");
  table.Add(IntegerOption("steps", "N", &O::sampling_steps, 0, 1000),
            "Denoising steps of each draw; 0 takes what the model says.");
  table.Add(RealOption("rs-strength", "SHARE", &O::rs_strength, {0.0, 2.0}),
            "Share of the estimated motion that is corrected.");
  table.Add(DeviceOption(&O::device));

  table.Group("Stabilization", OptionStage::kAnalysis);
  table.Add(
      RealOption("smoothness", "S", &O::smoothness_s, {0.0, 10.0}),
      "How calm the camera becomes: shake quicker than about this many seconds is taken out. 0 "
      "takes out rolling shutter only.");
  table.Add(SwitchOption("tripod", &O::tripod),
            "Hold the view still, as if the camera stood on a tripod (for clips that mean to).");
  table.Add(
      RealOption("crop", "RATIO", &O::min_crop_ratio, {0.1, 1.0}),
      "Smallest share of the picture's width and height that may be kept; the path is held closer "
      "to the camera's where it would need more.");
  table.Add(
      ZoomOption(),
      "How borders are hidden: adaptive zooms as much as each moment needs, fixed once for the "
      "whole clip, a factor is that fixed zoom itself.");
  table.Add(MeshOption(),
            "Cells over which the motion may differ; 1x1 moves the picture as a whole.");

  table.Group("Picture", OptionStage::kRender);
  table.Add(InterpolationOption(&O::interpolation));

  table.Group("Running");
  table.Add(IntegerOption("threads", "N", &O::num_threads, 0, 1024),
            "Threads to use; 0 takes one for each processor.");
  table.Group("Running", OptionStage::kAnalysis);
  table.Add(IntegerOption("seed", "N", &O::seed, 0, std::numeric_limits<std::int64_t>::max()),
            "Where random choices start. The same seed and thread count give the same file.");
  return table.Take();
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
