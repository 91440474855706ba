// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/simulate_options.h"

#include <limits>
#include <utility>
#include <vector>

namespace rsstab::cli {
namespace {

using pipeline::ChoiceOption;
using pipeline::IntegerOption;
using pipeline::OptionTable;
using pipeline::OptionTableBuilder;
using pipeline::RealOption;
using pipeline::SwitchOption;
using pipeline::TextOption;
using Options = SimulateOptions;

constexpr double kMilli = 1e-3;

std::vector<std::pair<std::string, igf::MotionPreset>> MotionChoices() {
  std::vector<std::pair<std::string, igf::MotionPreset>> choices;
  choices.reserve(igf::kMotionPresets.size());
  for (const igf::MotionPreset preset : igf::kMotionPresets) {
    choices.emplace_back(igf::MotionPresetName(preset), preset);
  }
  return choices;
}

OptionTable<Options> BuildTable() {
  OptionTableBuilder<Options> table;

  table.Group("Scene and motion");
  table.Add(
      TextOption<Options>("image", "FILE", &Options::image),
      "Picture to film, continued as in mirrors where the camera looks beyond it; without one the "
      "program paints a street.");
  table.Add(ChoiceOption<Options>("motion", &Options::motion, MotionChoices()),
            "How the camera is held.");
  table.Add(TextOption<Options>("motion-gyro", "FILE", &Options::motion_gyro),
            "Gyro log whose motion the camera follows instead.");
  table.Add(IntegerOption<Options>("seed", "N", &Options::seed, 0,
                                   std::numeric_limits<std::int64_t>::max()),
            "Another number is another motion of the same kind, another street, other noise.");
  table.Add(SwitchOption<Options>("foreground", &Options::foreground),
            "Let an object cross the scene, which no camera motion explains.");

  table.Group("Camera");
  table.Add(IntegerOption<Options>("width", "PX", &Options::width, 16, 8192),
            "Width of the clips.");
  table.Add(IntegerOption<Options>("height", "PX", &Options::height, 16, 8192),
            "Height of the clips.");
  table.Add(RealOption<Options>("fps", "N", &Options::fps, {1.0, 1000.0}),
            "Frames a second; 29.97 and the like mean 30000/1001.");
  table.Add(RealOption<Options>("duration", "S", &Options::duration_s, {0.0, 3600.0}),
            "Length of the clips; 10 s, or as long as the gyro log, unless given.");
  table.Add(
      RealOption<Options>("readout", "MS", &Options::readout_s, {-200.0, 200.0}, kMilli),
      "Readout time from the first row to the last, negative from bottom to top; what is usual for "
      "the motion unless given.");
  table.Add(RealOption<Options>("fov", "DEG", &Options::fov_deg, {5.0, 140.0}),
            "Horizontal angle of view.");
  table.Add(RealOption<Options>("focal", "PX", &Options::focal_px, {1.0, 1e5}),
            "Focal length; overrides the angle of view.");
  table.Add(RealOption<Options>("exposure", "MS", &Options::exposure_s, {0.0, 100.0}, kMilli),
            "Time over which each row gathers light: motion blur.");
  table.Add(
      RealOption<Options>("image-noise", "LEVELS", &Options::image_noise, {0.0, 50.0}),
      "Standard deviation of the noise of each sample, in 8-bit levels; none in clips, 2 with "
      "--rs-real unless given.");

  table.Group("Gyro log");
  table.Add(RealOption<Options>("gyro-rate", "HZ", &Options::gyro_rate_hz, {10.0, 20000.0}),
            "Samples a second of the log that is written.");
  table.Add(RealOption<Options>("gyro-offset", "S", &Options::gyro_offset_s, {-3600.0, 3600.0}),
            "Video time at the log's time 0.");
  table.Add(RealOption<Options>("gyro-noise", "RAD/S", &Options::gyro_noise_rad_s, {0.0, 10.0}),
            "Standard deviation of the noise of each sample and axis.");
  table.Add(RealOption<Options>("gyro-bias", "RAD/S", &Options::gyro_bias_rad_s, {0.0, 10.0}),
            "Size of a constant error of the gyro, in a direction drawn from the seed.");

  table.Group("Labelled pictures");
  table.Add(
      SwitchOption<Options>("rs-real", &Options::rs_real),
      "Write single pictures instead, with truth, motion field and gyro log, in the layout of the "
      "data set RS-Real: for `evaluate --dataset rs-real:FOLDER` and for training. Each photograph "
      "is taken with a weak, a medium and a strong motion; focal length and readout are drawn "
      "unless given.");
  table.Add(TextOption<Options>("photos", "FOLDER", &Options::photos),
            "--rs-real: the photographs; painted streets without it.");
  table.Add(IntegerOption<Options>("samples", "N", &Options::samples, 1, 1'000'000),
            "--rs-real: how many pictures.");
  table.Add(IntegerOption<Options>("frames", "N", &Options::frames, 1, 1000),
            "--rs-real: consecutive frames of each photograph and motion, as a sequence.");
  table.Add(RealOption<Options>("train-share", "N", &Options::train_share, {0.0, 1.0}),
            "--rs-real: how much of it becomes the train split; the rest is the test split.");
  table.Add(TextOption<Options>("size", "WxH", &Options::size), "--rs-real: of the pictures.");

  table.Group("Output");
  table.Add(RealOption<Options>("crf", "N", &Options::crf, {0.0, 51.0}),
            "Quality of the H.264 clips; 0 is lossless.");
  table.Add(SwitchOption<Options>("overwrite", &Options::overwrite), "Replace files that exist.");
  table.Add(IntegerOption<Options>("threads", "N", &Options::threads, 0, 1024),
            "Threads to use; 0 means one per core. The pictures are the same for any number.");
  return table.Take();
}

}  // namespace

Status Validate(const SimulateOptions& options, const std::set<std::string>& given) {
  const std::vector<const char*> useless =
      options.rs_real
          ? std::vector<const char*>{"image",    "motion",      "motion-gyro", "foreground",
                                     "width",    "height",      "duration",    "fov",
                                     "exposure", "gyro-offset", "crf"}
          : std::vector<const char*>{"photos", "samples", "frames", "train-share", "size"};
  for (const char* name : useless) {
    if (given.contains(name) && options.rs_real) {
      return Fail(ErrorCode::kInvalidArgument, "--{} is for clips: it does not go with --rs-real",
                  name);
    }
    if (given.contains(name)) {
      return Fail(ErrorCode::kInvalidArgument,
                  "--{} is for labelled pictures: it goes with --rs-real", name);
    }
  }
  return {};
}

const OptionTable<SimulateOptions>& SimulateOptionTable() {
  static const OptionTable<SimulateOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
