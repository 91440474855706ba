// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/correct_options.h"

#include <limits>
#include <utility>

#include "rsdiff/backend/backend_options.h"

namespace rsstab::cli {
namespace {

using pipeline::ChoiceOption;
using pipeline::IntegerOption;
using pipeline::OptionSpec;
using pipeline::OptionTable;
using pipeline::RealOption;
using pipeline::SwitchOption;
using pipeline::TextOption;
using stabilizer::Interpolation;
using Options = CorrectOptions;

std::vector<std::pair<std::string, std::string>> DeviceChoices() {
  std::vector<std::pair<std::string, std::string>> choices;
  for (const char* device : rsdiff::kDeviceNames) {
    choices.emplace_back(device, device);
  }
  return choices;
}

OptionTable<Options> BuildTable() {
  OptionTable<Options> table;
  std::string group;
  const auto add = [&](OptionSpec<Options> spec, std::string help) {
    spec.group = group;
    spec.help = std::move(help);
    table.push_back(std::move(spec));
  };

  group = "Output";
  auto output = TextOption<Options>("output", "OUT", &Options::output);
  output.short_name = 'o';
  add(std::move(output),
      "Where the corrected pictures go: a file for one picture (its ending chooses the format), a "
      "folder for several, made when it is missing, in which they keep their names. Metadata goes "
      "along.");
  add(TextOption<Options>("field", "DIR", &Options::field_folder),
      "Folder for the motion that was corrected, in pixels of the picture: NAME.flo (Middlebury), "
      "NAME.npz (field and its spread) and NAME-field.png (colours).");
  add(SwitchOption<Options>("overwrite", &Options::overwrite), "Replace files that exist.");
  add(IntegerOption<Options>("quality", "N", &Options::quality, 1, 100),
      "Quality of formats that lose something (JPEG, WebP, JPEG 2000).");

  group = "Picture";
  add(SwitchOption<Options>("full-frame", &Options::full_frame),
      "Keep the scale and let the edges go on where nothing was recorded, instead of enlarging the "
      "picture just so far that no border shows.");
  add(ChoiceOption<Options, Interpolation>("interpolation", &Options::interpolation,
                                           {{"bilinear", Interpolation::kBilinear},
                                            {"bicubic", Interpolation::kBicubic},
                                            {"lanczos", Interpolation::kLanczos}}),
      "How pixels are resampled, from quickest to sharpest.");
  add(RealOption<Options>("strength", "SHARE", &Options::strength, {0.0, 2.0}),
      "Share of the estimated motion that is corrected.");
  add(RealOption<Options>("focal", "PX", &Options::focal_px, {1.0, 1e6}),
      "Focal length in pixels of the picture. Without it from the EXIF data (35 mm equivalent), "
      "else one picture width.");

  group = "Diffusion";
  add(TextOption<Options>("model", "FILE", &Options::model),
      "Diffusion model: its JSON file, the folder of it, or the name of an installed one. Without "
      "it the installed compact model.");
  add(IntegerOption<Options>("samples", "N", &Options::samples, 1, 1024),
      "Motions drawn for each picture: their mean is corrected, their spread tells how sure it "
      "is.");
  add(IntegerOption<Options>("steps", "N", &Options::steps, 0, 1000),
      "Denoising steps of each draw; 0 takes what the model says.");
  add(RealOption<Options>("guidance", "SCALE", &Options::guidance, {0.0, 20.0}),
      "Classifier-free guidance: above 1 leans harder on the picture. Without it as the model "
      "says.");
  add(RealOption<Options>("eta", "SHARE", &Options::eta, {0.0, 1.0}),
      "Noise added at each step. Without it as the model says.");
  add(IntegerOption<Options>("seed", "N", &Options::seed, 0,
                             std::numeric_limits<std::int64_t>::max()),
      "Where the noise starts, the same for every picture.");
  add(ChoiceOption<Options, std::string>("device", &Options::device, DeviceChoices()),
      "Where the network runs; all but auto and cpu need an OpenCV (or libtorch) built for it.");

  group = "Running";
  add(IntegerOption<Options>("threads", "N", &Options::threads, 0, 1024),
      "Threads that resample; 0 takes one for each processor.");
  return table;
}

}  // namespace

const OptionTable<CorrectOptions>& CorrectOptionTable() {
  static const OptionTable<CorrectOptions> table = BuildTable();
  return table;
}

Status Validate(const CorrectOptions& options) {
  if (options.output.empty() && options.field_folder.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "nothing is asked for: name an output with -o, or a folder for motion fields with "
                "--field");
  }
  return pipeline::ValidateOptions(CorrectOptionTable(), options);
}

}  // namespace rsstab::cli
