// SPDX-License-Identifier: Apache-2.0
#include "cli/command_apps.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "stabilizer/pipeline/version.h"

namespace rsstab::cli {
namespace {

using pipeline::OptionSpec;
using pipeline::OptionStage;
using pipeline::OptionTable;

template <typename Options>
std::string Describe(const OptionSpec<Options>& spec) {
  std::string notes = spec.range;
  if (const std::string value = spec.get(Options()); !spec.IsSwitch() && !value.empty()) {
    notes += (notes.empty() ? "" : "; ") + ("default " + value);
  }
  return notes.empty() ? spec.help : spec.help + " [" + notes + "]";
}

template <typename Options>
void AddOption(CLI::App& app, const OptionSpec<Options>& spec, Options& target) {
  std::string names = "--" + spec.name;
  if (spec.short_name != '\0') {
    names = std::string("-") + spec.short_name + "," + names;
  }
  const auto store = [&spec, &target](const std::string& text) {
    if (const Status status = spec.set(target, text); !status) {
      throw CLI::ParseError(status.error().message, CLI::ExitCodes::ValidationError);
    }
  };
  CLI::Option* option = nullptr;
  if (spec.IsSwitch()) {
    option = app.add_flag_callback(
        names, [store] { store("true"); }, Describe(spec));
  } else if (spec.repeatable) {
    option = app.add_option_function<std::vector<std::string>>(
                    names,
                    [store](const std::vector<std::string>& values) {
                      std::for_each(values.begin(), values.end(), store);
                    },
                    Describe(spec))
                 ->expected(1)
                 ->take_all();
  } else {
    option = app.add_option_function<std::string>(names, store, Describe(spec))->take_last();
  }
  option->group(spec.group);
  if (!spec.IsSwitch()) {
    option->type_name(spec.value_name);
  }
}

// Those options of `table` that have one of these names.
template <typename Options>
void AddNamed(CLI::App& app, const OptionTable<Options>& table, Options& target,
              std::initializer_list<std::string_view> names) {
  for (const OptionSpec<Options>& spec : table) {
    if (std::find(names.begin(), names.end(), spec.name) != names.end()) {
      AddOption(app, spec, target);
    }
  }
}

// The options of `table` that belong to one of the two passes, or all.
template <typename Options>
void AddTable(CLI::App& app, const OptionTable<Options>& table, Options& target,
              std::optional<OptionStage> stage = std::nullopt) {
  for (const OptionSpec<Options>& spec : table) {
    if (!stage || spec.stage == *stage || spec.stage == OptionStage::kBoth) {
      AddOption(app, spec, target);
    }
  }
}

void AddFolder(CLI::App& app, Invocation& invocation) {
  app.add_option("FOLDER", invocation.simulate.output, "Where to write; made if it is missing.")
      ->required()
      ->type_name("")
      ->take_last();
}

void AddBothClips(CLI::App& app, Invocation& invocation) {
  app.add_option("IN", invocation.compare.input, "The clip before.")->required()->type_name("");
  app.add_option("OUT", invocation.compare.output, "The clip after.")->required()->type_name("");
}

void AddPictures(CLI::App& app, Invocation& invocation) {
  app.add_option("IMAGE", invocation.correct.images,
                 "Pictures: files, folders, and patterns such as 'holiday/*.jpg'.")
      ->required()
      ->type_name("");
}

void AddInput(CLI::App& app, Invocation& invocation) {
  app.add_option("IN", invocation.input, "The clip: any file that FFmpeg's libraries read.")
      ->required()
      ->type_name("")
      ->take_last();
}

std::vector<CommandText> BuildTexts() {
  return {
      {CommandId::kStabilize,
       "",
       "[OPTIONS] IN [-o OUT]",
       "steadies a video clip and takes its rolling shutter out",
       "Reads a shaky clip and writes a steady one of the same size, length and timestamps. The "
       "skew and wobble of a rolling shutter are removed as well: how the camera moved while a "
       "frame was read out is found from the clip itself, or read from a gyro log where there is "
       "one. Audio, subtitles, chapters and metadata are copied untouched.",
       {{"rs-stabilize shaky.mp4", "writes shaky-stable.mp4 beside it"},
        {"rs-stabilize shaky.mp4 -o steady.mkv --smoothness 2", "calmer, in another container"},
        {"rs-stabilize drone.mp4 --gyro drone.gcsv --camera lens.json", "with a separate gyro log"},
        {"rs-stabilize shaky.mp4 --tripod --zoom fixed", "as if from a tripod"},
        {"rs-stabilize shaky.mp4 --codec hevc --crf 22 --preset slow", "HEVC"}}},
      {CommandId::kAnalyze,
       "analyze",
       "[OPTIONS] IN [-o FILE]",
       "looks at a clip once and stores what was found",
       "Runs the first pass alone and writes an analysis file, from which `render` makes the "
       "steady "
       "clip as often as wanted.",
       {{"rs-stabilize analyze shaky.mp4", "writes shaky.rsstab beside it"}}},
      {CommandId::kCalibrate,
       "calibrate",
       "[OPTIONS] IN [-o CAMERA]",
       "finds readout time, focal length and gyro offset from a clip",
       "Looks at a clip once and prints what it tells about the camera that took it, how sure that "
       "is, and what it would take to be surer. Best is a clip of a few seconds in which the "
       "camera shakes while it turns on the spot; what it tells holds for every clip of that "
       "camera in that mode.",
       {{"rs-stabilize calibrate shaky.mp4", "for people"},
        {"rs-stabilize calibrate shaky.mp4 -o phone.json --curves readout.svg",
         "saves the camera, and draws the evidence"},
        {"rs-stabilize other.mp4 --camera phone.json", "uses it"}}},
      {CommandId::kRender,
       "render",
       "[OPTIONS] IN [ANALYSIS] [-o OUT]",
       "writes the steady clip from an analysis file",
       "Runs the second pass alone. An analysis file that was made from another clip is refused.",
       {{"rs-stabilize render shaky.mp4 --crf 14", "uses shaky.rsstab beside it"}}},
      {CommandId::kCorrect,
       "correct",
       "[OPTIONS] IMAGE... -o OUT",
       "takes the rolling shutter out of photographs",
       "Estimates from each picture alone how the camera moved while it was read out, and undoes "
       "what it can tell. Size, bit depth, transparency and metadata stay; the picture is enlarged "
       "just so far "
       "that no border shows. Rows are those of the stored picture, which are the sensor's: a "
       "picture whose pixels were turned afterwards cannot be corrected.",
       {{"rs-stabilize correct train.jpg -o upright.jpg", "one picture"},
        {"rs-stabilize correct 'trip/*.jpg' scans -o corrected", "many, into a folder"},
        {"rs-stabilize correct train.jpg --field fields", "the motion only"}}},
      {CommandId::kInfo,
       "info",
       "[OPTIONS] IN",
       "tells what a clip holds and what would be done with it",
       "Prints the clip's streams, the gyro log and camera found, and where the motion inside a "
       "frame would be taken from.",
       {{"rs-stabilize info shaky.mp4", "for people"},
        {"rs-stabilize info --json shaky.mp4", "for programs"},
        {"rs-stabilize info shaky.rsstab", "what an analysis file holds"}}},
      {CommandId::kCompare,
       "compare",
       "[OPTIONS] IN OUT",
       "measures a clip before and after",
       "Prints how much a clip shakes, jitters and wobbles before and after, how much of the "
       "picture "
       "was kept and how much it was bent; docs/metrics.md says what each figure means.",
       {{"rs-stabilize compare shaky.mp4 shaky-stable.mp4", "a table"},
        {"rs-stabilize compare walking/rs.mp4 steady.mp4 --truth walking --json",
         "with a simulated clip's truth, for programs"}}},
      {CommandId::kSimulate,
       "simulate",
       "[OPTIONS] FOLDER",
       "makes a shaky rolling-shutter clip of which everything is known",
       "Writes into FOLDER a rolling-shutter clip (rs.mp4), what a global shutter would have seen "
       "(gs.mp4), the gyro log (gyro.csv), the camera (camera.json) and the truth (truth.json); "
       "or, "
       "with --rs-real, a data set of labelled pictures.",
       {{"rs-stabilize simulate walking --motion walking", "ten seconds of walking"},
        {"rs-stabilize simulate mine --image photo.jpg --motion vibration --readout 28",
         "from a photograph"},
        {"rs-stabilize simulate set --rs-real --photos holidays --samples 300",
         "labelled pictures in RS-Real's layout"}}},
      {CommandId::kEvaluate,
       "evaluate",
       "[OPTIONS]",
       "measures how well rolling shutter is taken out, and how steady clips become",
       "Records photographs along known camera motions, or takes real pictures with their "
       "global-shutter truth, lets each method correct them, and prints how far each came. Of "
       "clips it has whole stabilizers, FFmpeg's too, make steady ones and measures those. "
       "docs/evaluation.md defines the protocols and figures.",
       {{"rs-stabilize evaluate --photos holidays", "known motions, the default model"},
        {"rs-stabilize evaluate --photos holidays --samples 16 --steps 8 --csv all.csv",
         "other sampling, every picture's figures"},
        {"rs-stabilize evaluate --dataset pairs:Fastec", "real pictures"},
        {"rs-stabilize evaluate --dataset rs-real:RS_Real --methods "
         "none,gyro,diffusion",
         "pictures with gyro logs or labels"},
        {"rs-stabilize evaluate --clips holidays --methods input,auto,off,vidstab",
         "whole clips"}}},
  };
}

}  // namespace

const std::vector<CommandText>& CommandTexts() {
  static const std::vector<CommandText> texts = BuildTexts();
  return texts;
}

const CommandText& TextOf(CommandId id) {
  const auto& texts = CommandTexts();
  return *std::find_if(texts.begin(), texts.end(),
                       [id](const CommandText& text) { return text.id == id; });
}

std::unique_ptr<CLI::App> MakeCommandApp(CommandId id, Invocation& invocation) {
  const CommandText& text = TextOf(id);
  auto app = std::make_unique<CLI::App>(
      text.description, text.name.empty() ? "rs-stabilize" : "rs-stabilize " + text.name);
  app->set_help_flag("-h,--help", "Print this help and exit.")->group("Running");
  invocation.command = id;
  if (id == CommandId::kSimulate) {
    AddFolder(*app, invocation);
  } else if (id == CommandId::kCompare) {
    AddBothClips(*app, invocation);
  } else if (id == CommandId::kCorrect) {
    AddPictures(*app, invocation);
  } else if (id != CommandId::kEvaluate) {
    AddInput(*app, invocation);
  }
  const auto& stabilize = pipeline::StabilizeOptionTable();
  switch (id) {
    case CommandId::kStabilize:
      AddTable(*app, EncodeOptionTable(), invocation.encode);
      AddTable(*app, stabilize, invocation.stabilize);
      AddTable(*app, RunOptionTable(), invocation.run);
      app->set_version_flag("--version", std::string("rs-stabilize ") + pipeline::kProgramVersion,
                            "Print the version and exit.")
          ->group("Running");
      break;
    case CommandId::kAnalyze:
      app->add_option(
             "-o,--output", invocation.analysis_file,
             "Analysis file to write. Without it, beside the clip with the ending .rsstab.")
          ->type_name("FILE")
          ->group("Output")
          ->take_last();
      app->add_flag("--overwrite", invocation.encode.overwrite,
                    "Replace the analysis file if it exists.")
          ->group("Output");
      AddTable(*app, stabilize, invocation.stabilize, OptionStage::kAnalysis);
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
    case CommandId::kCalibrate:
      AddTable(*app, CalibrateOptionTable(), invocation.calibrate);
      AddNamed(*app, stabilize, invocation.stabilize,
               {"gyro", "gyro-axes", "gyro-offset", "readout", "focal", "camera", "model", "device",
                "threads"});
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
    case CommandId::kRender:
      app->add_option("ANALYSIS", invocation.analysis_file,
                      "The analysis file. Without it, the one beside the clip.")
          ->type_name("");
      AddTable(*app, EncodeOptionTable(), invocation.encode);
      AddTable(*app, stabilize, invocation.stabilize, OptionStage::kRender);
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
    case CommandId::kInfo:
      app->add_flag("--json", invocation.json, "Print one JSON object instead of text.")
          ->group("Output");
      AddTable(*app, stabilize, invocation.stabilize, OptionStage::kAnalysis);
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
    case CommandId::kCorrect:
      AddTable(*app, CorrectOptionTable(), invocation.correct);
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
    case CommandId::kCompare:
      AddTable(*app, CompareOptionTable(), invocation.compare);
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
    case CommandId::kSimulate:
      AddTable(*app, SimulateOptionTable(), invocation.simulate);
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
    case CommandId::kEvaluate:
      AddTable(*app, EvaluateOptionTable(), invocation.evaluate);
      AddTable(*app, RunOptionTable(), invocation.run);
      break;
  }
  return app;
}

std::string OptionFlags(const CLI::Option& option) {
  if (option.get_positional()) {
    return option.get_name(true);
  }
  std::string flags;
  for (const std::string& name : option.get_snames()) {
    flags += "-" + name + ", ";
  }
  flags += "--" + option.get_lnames().front();
  if (option.get_items_expected_max() > 0) {
    flags += " " + option.get_type_name();
  }
  return flags;
}

std::vector<OptionGroup> VisibleOptions(const CLI::App& app) {
  std::vector<OptionGroup> groups(1);  // the positional arguments come first
  for (const CLI::Option* option : app.get_options()) {
    const std::string heading = option->get_positional() ? "" : option->get_group();
    if (heading.empty() && !option->get_positional()) {
      continue;  // hidden
    }
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&heading](const OptionGroup& g) { return g.heading == heading; });
    if (group == groups.end()) {
      group = groups.insert(groups.end(), {heading, {}});
    }
    group->options.push_back(option);
  }
  // Where help and version were defined first, their heading still comes last.
  std::stable_partition(groups.begin(), groups.end(),
                        [](const OptionGroup& g) { return g.heading != "Running"; });
  return groups;
}

}  // namespace rsstab::cli
