// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_STABILIZE_OPTIONS_H_
#define RSSTAB_STABILIZER_PIPELINE_STABILIZE_OPTIONS_H_

#include <cstdint>
#include <optional>
#include <string>

#include "igf/base/result.h"
#include "stabilizer/interpolation.h"
#include "stabilizer/pipeline/option_table.h"

namespace rsstab::pipeline {

// What tells how the camera moved while a frame was read out.
enum class RsChoice {
  kAuto,       // a gyro log when there is a trustworthy one, else as kFused
  kFused,      // one camera rotation for the clip, from tracks and single pictures
  kGyro,       // a gyro log, or fail
  kDiffusion,  // each frame's picture, by a diffusion model
  kTracks,     // as kFused without looking at single pictures
  kOff,        // leave rolling shutter alone
};

// How the picture is enlarged to hide the borders that move in.
enum class ZoomMode {
  kAdaptive,  // as much as each moment needs, changing slowly
  kFixed,     // one zoom for the whole clip
};

// What the user wants of the stabilizer itself (reading, encoding and reporting are the host's).
// The member initialisers ARE the defaults; meanings, units and ranges are in
// StabilizeOptionTable() and are what help pages and the manual print.
struct StabilizeOptions {
  RsChoice rs = RsChoice::kAuto;
  std::string gyro_file;                // empty: the clip's own telemetry track
  std::string gyro_axes;                // sensor axes -> camera axes; empty: as the log says
  std::optional<double> gyro_offset_s;  // t_video = t_gyro + offset; empty: found from the picture
  std::optional<double> readout_s;      // see rolling_shutter.h; empty: camera file, log, or found
  std::optional<double> focal_px;  // at the clip's full size; empty: camera file, log, or found
  std::string camera_file;         // camera JSON or lens profile

  // Only for kDiffusion.
  std::string model;         // see rsdiff/model_path.h; empty: the installed compact model
  int samples = 8;           // drawn for each frame; their mean is taken
  int sampling_steps = 0;    // DDIM steps; 0 = as the model says
  double rs_strength = 1.0;  // share of the estimated motion that is corrected
  std::string device = "auto";

  double smoothness_s = 1.0;    // time constant of the smooth path; 0 = only rolling shutter
  bool tripod = false;          // hold one view for each scene
  double min_crop_ratio = 0.8;  // smallest kept share of a side, in (0, 1]
  ZoomMode zoom = ZoomMode::kAdaptive;
  std::optional<double> fixed_zoom;  // only with kFixed; empty: the smallest that hides borders
  int mesh_columns = 16;
  int mesh_rows = 16;

  stabilizer::Interpolation interpolation = stabilizer::Interpolation::kBicubic;

  int num_threads = 0;  // 0 = one per processor
  std::uint64_t seed = 0;
};

// Every option once: name, value, range, help. Any thread.
[[nodiscard]] const OptionTable<StabilizeOptions>& StabilizeOptionTable();

// Checks each value and what must go together. Errors: kInvalidArgument naming the option.
[[nodiscard]] Status Validate(const StabilizeOptions& options);

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_STABILIZE_OPTIONS_H_
