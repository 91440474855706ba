// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/correct_options.h"

#include <limits>

#include "stabilizer/pipeline/shared_options.h"

namespace rsstab::cli {
namespace {

using pipeline::DeviceOption;
using pipeline::IntegerOption;
using pipeline::InterpolationOption;
using pipeline::ModelOption;
using pipeline::OptionTable;
using pipeline::OptionTableBuilder;
using pipeline::RealOption;
using pipeline::SwitchOption;
using pipeline::TextOption;
using Options = CorrectOptions;

OptionTable<Options> BuildTable() {
  OptionTableBuilder<Options> table;

  table.Group("Output");
  table.Add(
      TextOption<Options>("output", "OUT", &Options::output, 'o'),
      "Where the corrected pictures go: a file for one picture (its ending chooses the format), a "
      "folder for several, made when it is missing, in which they keep their names. Metadata goes "
      "along.");
  table.Add(
      TextOption<Options>("field", "DIR", &Options::field_folder),
      "Folder for the motion that was corrected, in pixels of the picture: NAME.flo (Middlebury), "
      "NAME.npz (field and its spread) and NAME-field.png (colours).");
  table.Add(SwitchOption<Options>("overwrite", &Options::overwrite), "Replace files that exist.");
  table.Add(IntegerOption<Options>("quality", "N", &Options::quality, 1, 100),
            "Quality of formats that lose something (JPEG, WebP, JPEG 2000).");

  table.Group("Picture");
  table.Add(
      SwitchOption<Options>("full-frame", &Options::full_frame),
      "Keep the scale and let the edges go on where nothing was recorded, instead of enlarging the "
      "picture just so far that no border shows.");
  table.Add(InterpolationOption(&Options::interpolation));
  table.Add(RealOption<Options>("strength", "SHARE", &Options::strength, {0.0, 2.0}),
            "Share of the estimated motion that is corrected.");
  table.Add(
      RealOption<Options>("focal", "PX", &Options::focal_px, {1.0, 1e6}),
      "Focal length in pixels of the picture. Without it from the EXIF data (35 mm equivalent), "
      "else one picture width.");

  table.Group("Diffusion");
  table.Add(ModelOption(&Options::model));
  table.Add(
      IntegerOption<Options>("samples", "N", &Options::samples, 1, 1024),
      "Motions drawn for each picture: their mean is corrected, their spread tells how sure it "
      "is.");
  table.Add(IntegerOption<Options>("steps", "N", &Options::steps, 0, 1000),
            "Denoising steps of each draw; 0 takes what the model says.");
  table.Add(
      RealOption<Options>("guidance", "SCALE", &Options::guidance, {0.0, 20.0}),
      "Classifier-free guidance: above 1 leans harder on the picture. Without it as the model "
      "says.");
  table.Add(RealOption<Options>("eta", "SHARE", &Options::eta, {0.0, 1.0}),
            "Noise added at each step. Without it as the model says.");
  table.Add(IntegerOption<Options>("seed", "N", &Options::seed, 0,
                                   std::numeric_limits<std::int64_t>::max()),
            "Where the noise starts, the same for every picture.");
  table.Add(DeviceOption(&Options::device));

  table.Group("Running");
  table.Add(IntegerOption<Options>("threads", "N", &Options::threads, 0, 1024),
            "Threads that resample; 0 takes one for each processor.");
  return table.Take();
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
