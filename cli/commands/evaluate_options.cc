// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_options.h"

#include <spdlog/fmt/fmt.h>

#include <limits>

#include "cli/commands/clip_method.h"
#include "cli/commands/evaluate_methods.h"
#include "stabilizer/pipeline/shared_options.h"

namespace rsstab::cli {
namespace {

using pipeline::ChoiceOption;
using pipeline::DeviceOption;
using pipeline::IntegerOption;
using pipeline::OptionSpec;
using pipeline::OptionTable;
using pipeline::OptionTableBuilder;
using pipeline::RealOption;
using pipeline::SwitchOption;
using pipeline::TextOption;
using Options = EvaluateOptions;

// "rs-real:FOLDER": protocol and folder at once.
OptionSpec<Options> DatasetOption() {
  struct Kind {
    const char* name;
    EvaluationProtocol protocol;
    std::string Options::*folder;
  };
  static const std::vector<Kind> kinds = {
      {"rs-real", EvaluationProtocol::kRsReal, &Options::rs_real},
      {"pairs", EvaluationProtocol::kPairs, &Options::pairs},
      {"synthetic-val", EvaluationProtocol::kSyntheticVal, &Options::photos},
      {"clips", EvaluationProtocol::kClips, &Options::clips}};
  OptionSpec<Options> spec;
  spec.name = "dataset";
  spec.value_name = "KIND:FOLDER";
  spec.set = [](Options& options, const std::string& text) -> Status {
    for (const Kind& kind : kinds) {
      const std::string prefix = std::string(kind.name) + ":";
      if (text.starts_with(prefix) && text.size() > prefix.size()) {
        options.protocol = kind.protocol;
        options.*kind.folder = text.substr(prefix.size());
        return {};
      }
    }
    return pipeline::BadOption(
        "dataset", text, "rs-real:FOLDER, pairs:FOLDER, synthetic-val:FOLDER or clips:FOLDER");
  };
  spec.get = [](const Options& options) -> std::string {
    for (const Kind& kind : kinds) {
      if (options.protocol == kind.protocol && !(options.*kind.folder).empty()) {
        return std::string(kind.name) + ":" + options.*kind.folder;
      }
    }
    return "";
  };
  return spec;
}

OptionTable<Options> BuildTable() {
  OptionTableBuilder<Options> table;

  table.Group("Data");
  table.Add(
      DatasetOption(),
      "What to evaluate on, and where it lies: RS-Real as published or as `simulate --rs-real` "
      "wrote it, pairs of rolling- and global-shutter pictures, or what --photos and --clips "
      "name.");
  table.Add(
      ChoiceOption<Options>("protocol", &Options::protocol,
                            {{"synthetic-val", EvaluationProtocol::kSyntheticVal},
                             {"pairs", EvaluationProtocol::kPairs},
                             {"rs-real", EvaluationProtocol::kRsReal},
                             {"clips", EvaluationProtocol::kClips}}),
      "What to evaluate on: photographs recorded along known motions, real pictures with their "
      "global-shutter truth, or whole clips.");
  table.Add(TextOption<Options>("photos", "FOLDER", &Options::photos),
            "synthetic-val: the photographs.");
  table.Add(
      TextOption<Options>("pairs", "FOLDER", &Options::pairs),
      "pairs: where to look for rs_1.png beside gs_1.png, 001_rolling.png beside "
      "001_global_middle.png, rs/a.png and gs/a.png, or a_rs.png beside a_gs.png; the true field "
      "of "
      "the last two may lie beside as a.flo or a.npz.");
  table.Add(
      ChoiceOption<Options>("reference-row", &Options::reference_row,
                            {{"middle", ReferenceRow::kMiddle}, {"first", ReferenceRow::kFirst}}),
      "pairs: the row whose instant the global-shutter picture shows, where file names do not "
      "say.");
  table.Add(ChoiceOption<Options>("split", &Options::split,
                                  {{"all", DatasetSplit::kAll},
                                   {"train", DatasetSplit::kTrain},
                                   {"test", DatasetSplit::kTest}}),
            "rs-real: which samples; the table tells the splits apart.");
  table.Add(
      TextOption<Options>("clips", "FOLDER", &Options::clips),
      "clips: video files, and folders that `rs-stabilize simulate` wrote. Implies the protocol.");
  table.Add(
      SwitchOption<Options>("twins", &Options::twins),
      "clips: also steady the global-shutter twin of each simulated clip, which has nothing to "
      "correct.");
  table.Add(
      TextOption<Options>("structured", "FILE", &Options::structured),
      "synthetic-val: list of photographs that are told apart as well, one a line; what follows a "
      "comma is ignored.");
  table.Add(TextOption<Options>("structured-source", "TEXT", &Options::structured_source),
            "Only the lines of that list that contain TEXT count.");
  table.Add(
      IntegerOption<Options>("limit", "N", &Options::limit, 0, 1'000'000'000),
      "Use the first N photographs, pictures (to the end of their clip) or clips; 0 means all.");
  table.Add(
      IntegerOption<Options>("linearity-photos", "N", &Options::linearity_photos, 0, 1'000'000'000),
      "synthetic-val: skew the first N photographs by known factors, to see whether the answer "
      "grows with the motion; 0 leaves this out.");

  table.Group("Methods");
  table.Add(
      TextOption<Options>("methods", "LIST", &Options::methods),
      fmt::format("Which to compare, separated by commas. Of pictures: {}. Data sets are given "
                  "all but mean, sample and regression unless told otherwise. Of clips: {} (the "
                  "last two are FFmpeg's, where an ffmpeg is installed), all of them unless given; "
                  "main options may follow, as in off@smoothness=2.",
                  PictureMethodHelp(), fmt::join(ClipMethodNames(), ", ")));
  table.Add(
      TextOption<Options>("model", "FILE", &Options::model),
      "Model file, its folder, or the name of an installed model; the default model unless given.");
  table.Add(TextOption<Options>("regression-model", "FILE", &Options::regression_model),
            "A second model, asked for one sample: direct regression.");
  table.Add(TextOption<Options>("reference-model", "FILE", &Options::reference_model),
            "Weights of the published network, for the method reference.");
  table.Add(DeviceOption(&Options::device), "Where the networks run.");
  table.Add(IntegerOption<Options>("samples", "N", &Options::samples, 1, 1024),
            "How many samples the methods mean, diffusion and reference draw.");
  table.Add(
      IntegerOption<Options>("calibration-samples", "N", &Options::calibration_samples, 0, 1024),
      "synthetic-val: how many samples the spread is judged by, at least 9; 0 leaves this out.");
  table.Add(IntegerOption<Options>("steps", "N", &Options::steps, 0, 1000),
            "Steps of the diffusion model; 0 means the model's own number.");
  table.Add(RealOption<Options>("guidance", "N", &Options::guidance, {0.0, 100.0}),
            "Classifier-free guidance scale; the model's own unless given.");
  table.Add(RealOption<Options>("eta", "N", &Options::eta, {0.0, 1.0}),
            "Noise added at each step; the model's own unless given.");
  table.Add(SwitchOption<Options>("know-focal", &Options::know_focal),
            "Tell the methods the true focal length. Otherwise they assume one picture width.");

  table.Group("Output");
  table.Add(TextOption<Options>("csv", "FILE", &Options::csv),
            "Write one line for each picture and method.");
  table.Add(TextOption<Options>("json", "FILE", &Options::json),
            "Write the table's figures as JSON.");
  table.Add(TextOption<Options>("report", "FILE", &Options::report),
            "Write an HTML page, all in one file, with tables, charts and some of the pictures.");
  table.Add(SwitchOption<Options>("overwrite", &Options::overwrite), "Replace files that exist.");
  table.Add(
      TextOption<Options>("state", "FILE", &Options::state),
      "rs-real, pairs: keep what is done in FILE, and go on from it when the same is asked again "
      "after a stop. Without it, beside the CSV or JSON until that is written.");
  table.Add(RealOption<Options>("crf", "N", &Options::crf, {0.0, 51.0}),
            "clips: quality of the H.264 that every method writes.");
  table.Add(TextOption<Options>("preset", "NAME", &Options::preset),
            "clips: x264's preset for it.");

  table.Group("Running");
  table.Add(IntegerOption<Options>("seed", "N", &Options::seed, 0,
                                   std::numeric_limits<std::int64_t>::max()),
            "Another number is other motions and other noise.");
  table.Add(IntegerOption<Options>("jobs", "N", &Options::jobs, 0, 1024),
            "Photographs at a time; 0 means one per core. Every figure but ms is the same for any "
            "number.");
  return table.Take();
}

}  // namespace

const pipeline::OptionTable<EvaluateOptions>& EvaluateOptionTable() {
  static const pipeline::OptionTable<EvaluateOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
