// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_SIMULATE_OPTIONS_H_
#define RSSTAB_CLI_COMMANDS_SIMULATE_OPTIONS_H_

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "igf/motion_presets.h"
#include "stabilizer/pipeline/option_table.h"

namespace rsstab::cli {

// What `rs-stabilize simulate` is told. Defaults are the member initialisers.
struct SimulateOptions {
  std::string output;            // folder for rs.mp4, gs.mp4, gyro.csv, camera.json, truth.json
  bool rs_real = false;          // labelled pictures in RS-Real's layout instead of a clip
  std::string photos;            // rs-real: folder of photographs; empty: painted streets
  int samples = 30;              // rs-real: how many pictures
  int frames = 1;                // rs-real: of each clip
  double train_share = 0.0;      // rs-real: of the clips
  std::string size = "800x600";  // rs-real: of the pictures
  std::string image;             // still picture that becomes the scene; empty: a painted street
  igf::MotionPreset motion = igf::MotionPreset::kHandheld;
  std::string motion_gyro;  // gyro log whose motion is used instead of a preset
  std::int64_t seed = 1;

  int width = 1280;
  int height = 720;
  double fps = 30.0;
  std::optional<double> duration_s;  // 10 s, or less where the gyro log is shorter
  std::optional<double> readout_s;   // what goes with the preset; 20 ms for a gyro log
  double fov_deg = 60.0;             // horizontal angle of view
  std::optional<double> focal_px;    // overrides fov_deg

  double gyro_rate_hz = 1000.0;
  double gyro_offset_s = 0.0;     // t_video = t_gyro + offset
  double gyro_noise_rad_s = 0.0;  // standard deviation per axis and sample
  double gyro_bias_rad_s = 0.0;   // length of a bias whose direction the seed draws

  bool foreground = false;            // a moving object
  double exposure_s = 0.0;            // motion blur
  std::optional<double> image_noise;  // 8-bit levels; none in clips, 2 in rs-real unless given

  double crf = 8.0;  // of x264; 0 = lossless
  bool overwrite = false;
  int threads = 0;  // 0 = one per core
};

// Whether the options go together: single pictures have some of their own, and do without some of
// the clips'. `given`: long names of the options that the user wrote. Errors: kInvalidArgument
// naming the option.
[[nodiscard]] Status Validate(const SimulateOptions& options, const std::set<std::string>& given);

// All options but `output`, which is the command's positional argument.
[[nodiscard]] const pipeline::OptionTable<SimulateOptions>& SimulateOptionTable();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_SIMULATE_OPTIONS_H_
