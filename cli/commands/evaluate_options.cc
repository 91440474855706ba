// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_options.h"

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
using Options = EvaluateOptions;

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

  group = "Data";
  add(ChoiceOption<Options>("protocol", &Options::protocol,
                            {{"synthetic-val", EvaluationProtocol::kSyntheticVal},
                             {"pairs", EvaluationProtocol::kPairs},
                             {"clips", EvaluationProtocol::kClips}}),
      "What to evaluate on: photographs recorded along known motions, real pictures with their "
      "global-shutter truth, or whole clips.");
  add(TextOption<Options>("photos", "FOLDER", &Options::photos), "synthetic-val: the photographs.");
  add(TextOption<Options>("pairs", "FOLDER", &Options::pairs),
      "pairs: where to look for folders that hold rs_1.png and gs_1.png.");
  add(TextOption<Options>("clips", "FOLDER", &Options::clips),
      "clips: video files, and folders that `rs-stabilize simulate` wrote. Implies the protocol.");
  add(SwitchOption<Options>("twins", &Options::twins),
      "clips: also steady the global-shutter twin of each simulated clip, which has nothing to "
      "correct.");
  add(TextOption<Options>("structured", "FILE", &Options::structured),
      "synthetic-val: list of photographs that are told apart as well, one a line; what follows a "
      "comma is ignored.");
  add(TextOption<Options>("structured-source", "TEXT", &Options::structured_source),
      "Only the lines of that list that contain TEXT count.");
  add(IntegerOption<Options>("limit", "N", &Options::limit, 0, 1'000'000'000),
      "Use the first N photographs, pairs or clips; 0 means all.");
  add(IntegerOption<Options>("linearity-photos", "N", &Options::linearity_photos, 0, 1'000'000'000),
      "synthetic-val: skew the first N photographs by known factors, to see whether the answer "
      "grows with the motion; 0 leaves this out.");

  group = "Methods";
  add(TextOption<Options>("methods", "LIST", &Options::methods),
      "Which to compare, separated by commas: none (the picture as it is; always there), "
      "regression (where --regression-model names one), sample, mean. Of clips: input, any word of "
      "the main command's --rs, vidstab and deshake (FFmpeg's, where an ffmpeg is installed), all "
      "of them unless given; main options may follow, as in off+smoothness=2.");
  add(TextOption<Options>("model", "FILE", &Options::model),
      "Model file, its folder, or the name of an installed model; the default model unless given.");
  add(TextOption<Options>("regression-model", "FILE", &Options::regression_model),
      "A second model, asked for one sample: direct regression.");
  add(ChoiceOption<Options>("device", &Options::device, DeviceChoices()),
      "Where the networks run.");
  add(IntegerOption<Options>("samples", "N", &Options::samples, 1, 1024),
      "How many samples the method mean draws.");
  add(IntegerOption<Options>("calibration-samples", "N", &Options::calibration_samples, 0, 1024),
      "synthetic-val: how many samples the spread is judged by, at least 9; 0 leaves this out.");
  add(IntegerOption<Options>("steps", "N", &Options::steps, 0, 1000),
      "Steps of the diffusion model; 0 means the model's own number.");
  add(RealOption<Options>("guidance", "N", &Options::guidance, {0.0, 100.0}),
      "Classifier-free guidance scale; the model's own unless given.");
  add(RealOption<Options>("eta", "N", &Options::eta, {0.0, 1.0}),
      "Noise added at each step; the model's own unless given.");
  add(SwitchOption<Options>("know-focal", &Options::know_focal),
      "Tell the methods the true focal length. Otherwise they assume one picture width.");

  group = "Output";
  add(TextOption<Options>("csv", "FILE", &Options::csv),
      "Write one line for each picture and method.");
  add(TextOption<Options>("json", "FILE", &Options::json), "Write the table's figures as JSON.");

  add(RealOption<Options>("crf", "N", &Options::crf, {0.0, 51.0}),
      "clips: quality of the H.264 that every method writes.");
  add(TextOption<Options>("preset", "NAME", &Options::preset), "clips: x264's preset for it.");

  group = "Running";
  add(IntegerOption<Options>("seed", "N", &Options::seed, 0,
                             std::numeric_limits<std::int64_t>::max()),
      "Another number is other motions and other noise.");
  add(IntegerOption<Options>("jobs", "N", &Options::jobs, 0, 1024),
      "Photographs at a time; 0 means one per core. Every figure but ms is the same for any "
      "number.");
  return table;
}

}  // namespace

const pipeline::OptionTable<EvaluateOptions>& EvaluateOptionTable() {
  static const pipeline::OptionTable<EvaluateOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
