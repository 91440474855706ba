// SPDX-License-Identifier: Apache-2.0
#include "cli/cli_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "cli/command_apps.h"
#include "cli/commands/clip_method.h"
#include "cli/commands/evaluate_methods.h"
#include "cli/commands/method_list.h"

namespace rsstab::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Invocation Parsed(const std::vector<std::string>& arguments) {
  const auto result = ParseCommandLine(arguments);
  if (const auto* exit = std::get_if<EarlyExit>(&result)) {
    ADD_FAILURE() << exit->output << exit->error;
    return {};
  }
  return std::get<Invocation>(result);
}

EarlyExit Refused(const std::vector<std::string>& arguments) {
  const auto result = ParseCommandLine(arguments);
  if (const auto* exit = std::get_if<EarlyExit>(&result)) {
    return *exit;
  }
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(CliOptions, InputAloneIsTheMainJob) {
  const Invocation invocation = Parsed({"clip.mp4"});
  EXPECT_EQ(invocation.command, CommandId::kStabilize);
  EXPECT_EQ(invocation.input, "clip.mp4");
  EXPECT_EQ(invocation.encode.output, "");
}

TEST(CliOptions, EveryNameInTheManualReachesItsField) {
  const Invocation invocation = Parsed({"--rs",
                                        "gyro",
                                        "--gyro",
                                        "g.csv",
                                        "--gyro-offset",
                                        "-1.5",
                                        "--readout",
                                        "-16",
                                        "--focal",
                                        "900",
                                        "--camera",
                                        "c.json",
                                        "--threads",
                                        "2",
                                        "--progress",
                                        "json",
                                        "--seed",
                                        "7",
                                        "--log-level",
                                        "debug",
                                        "--smoothness",
                                        "0.5",
                                        "--crop=0.9",
                                        "--zoom",
                                        "1.2",
                                        "--mesh",
                                        "8x4",
                                        "--tripod",
                                        "--interpolation",
                                        "lanczos",
                                        "--codec",
                                        "libx265",
                                        "--crf",
                                        "20",
                                        "--preset",
                                        "fast",
                                        "--pix-fmt",
                                        "yuv420p10le",
                                        "--encoder-option",
                                        "x265-params=a=1:b=2",
                                        "--encoder-option",
                                        "tune=grain",
                                        "--overwrite",
                                        "in.mov",
                                        "-o",
                                        "-"});
  EXPECT_EQ(invocation.input, "in.mov");
  EXPECT_EQ(invocation.stabilize.rs, pipeline::RsChoice::kGyro);
  EXPECT_EQ(invocation.stabilize.gyro_file, "g.csv");
  EXPECT_EQ(invocation.stabilize.gyro_offset_s, -1.5);
  EXPECT_DOUBLE_EQ(*invocation.stabilize.readout_s, -0.016);
  EXPECT_EQ(invocation.stabilize.focal_px, 900.0);
  EXPECT_EQ(invocation.stabilize.camera_file, "c.json");
  EXPECT_EQ(invocation.stabilize.num_threads, 2);
  EXPECT_EQ(invocation.run.progress, ProgressStyle::kJson);
  EXPECT_EQ(invocation.stabilize.seed, 7U);
  EXPECT_EQ(invocation.run.log_level, LogLevel::kDebug);
  EXPECT_EQ(invocation.stabilize.smoothness_s, 0.5);
  EXPECT_EQ(invocation.stabilize.min_crop_ratio, 0.9);
  EXPECT_EQ(invocation.stabilize.fixed_zoom, 1.2);
  EXPECT_EQ(invocation.stabilize.mesh_rows, 4);
  EXPECT_TRUE(invocation.stabilize.tripod);
  EXPECT_EQ(invocation.stabilize.interpolation, stabilizer::Interpolation::kLanczos);
  EXPECT_EQ(invocation.encode.codec, "libx265");
  EXPECT_EQ(invocation.encode.crf, 20.0);
  EXPECT_EQ(invocation.encode.preset, "fast");
  EXPECT_EQ(invocation.encode.pix_fmt, "yuv420p10le");
  ASSERT_EQ(invocation.encode.encoder_options.size(), 2U);
  EXPECT_EQ(invocation.encode.encoder_options[0].second, "a=1:b=2");
  EXPECT_TRUE(invocation.encode.overwrite);
  EXPECT_EQ(invocation.encode.output, "-");
}

TEST(CliOptions, CommandsAreTheFirstWordOnly) {
  EXPECT_EQ(Parsed({"analyze", "clip.mp4"}).command, CommandId::kAnalyze);
  EXPECT_EQ(Parsed({"analyze", "clip.mp4", "-o", "a"}).analysis_file, "a");
  EXPECT_EQ(Parsed({"render", "clip.mp4", "a", "-o", "b"}).analysis_file, "a");
  EXPECT_EQ(Parsed({"info", "--json", "clip.mp4"}).command, CommandId::kInfo);
  const Invocation calibrate = Parsed({"calibrate", "clip.mp4", "-o", "camera.json", "--curves",
                                       "c.svg", "--gyro", "log.csv", "--json"});
  EXPECT_EQ(calibrate.command, CommandId::kCalibrate);
  EXPECT_EQ(calibrate.input, "clip.mp4");
  EXPECT_EQ(calibrate.calibrate.output, "camera.json");
  EXPECT_EQ(calibrate.calibrate.curves, "c.svg");
  EXPECT_EQ(calibrate.stabilize.gyro_file, "log.csv");
  EXPECT_TRUE(calibrate.calibrate.json);
  const Invocation compare = Parsed({"compare", "a.mp4", "b.mp4", "--truth", "folder"});
  EXPECT_EQ(compare.compare.input, "a.mp4");
  EXPECT_EQ(compare.compare.output, "b.mp4");
  EXPECT_EQ(compare.compare.truth, "folder");
  EXPECT_EQ(Parsed({"simulate", "folder", "--seed", "5"}).simulate.seed, 5);
  const Invocation correct = Parsed({"correct", "a.jpg", "b*.png", "-o", "new", "--field", "f"});
  EXPECT_EQ(correct.command, CommandId::kCorrect);
  EXPECT_THAT(correct.correct.images, ::testing::ElementsAre("a.jpg", "b*.png"));
  EXPECT_EQ(correct.correct.output, "new");
  EXPECT_EQ(correct.correct.field_folder, "f");
  const Invocation clip = Parsed({"./analyze"});
  EXPECT_EQ(clip.command, CommandId::kStabilize);
  EXPECT_EQ(clip.input, "./analyze");
  EXPECT_EQ(Parsed({"clip.mp4", "-o", "render"}).encode.output, "render");
  EXPECT_EQ(Parsed({"--", "-odd.mp4"}).input, "-odd.mp4");
}

TEST(CliOptions, WrongUsageIsExitCodeTwoAndOneSentence) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"--no-such-option", "a.mp4"},
      {"a.mp4", "b.mp4"},
      {"a.mp4", "--crop", "2"},
      {"a.mp4", "--crop"},
      {"a.mp4", "--mesh", "16"},
      {"a.mp4", "--smoothness", "nan"},
      {"a.mp4", "--encoder-option", "noequals"},
      {"a.mp4", "--rs", "off", "--gyro", "g.csv"},
      {"a.mp4", "--rs", "diffusion", "--gyro", "g"},
      {"correct"},
      {"correct", "a.jpg"},
      {"correct", "a.jpg", "-o", "b", "--eta", "2"},
      {"evaluate"},
      {"evaluate", "--protocol", "rs-real"},
      {"evaluate", "--dataset", "rs-real:set", "--photos", "photos"},
      {"evaluate", "--photos", "photos", "--clips", "clips"},
      {"evaluate", "--dataset", "clips:clips", "--clips", "other"},
      {"evaluate", "--dataset", "rs-real:set", "--protocol", "pairs"},
      {"evaluate", "--pairs", "set"},
      {"evaluate", "--photos", "photos", "--methods", "none,bogus"},
      {"evaluate", "--photos", "photos", "--methods", "diffusion@speed=2"},
      {"evaluate", "--photos", "photos", "--calibration-samples", "4"},
      {"evaluate", "--photos", "photos", "--state", "state"},
      {"evaluate", "--clips", "clips", "--methods", "off@smoothness=99"},
      {"evaluate", "--clips", "clips", "--methods", "none"},
      {"simulate", "set", "--rs-real", "--duration", "2"},
      {"simulate", "set", "--rs-real", "--foreground"},
      {"simulate", "clip", "--samples", "30"},
      {"simulate", "clip", "--size", "640x480"},
      {"render"},
      {"analyze", "a.mp4", "--crf", "18"},
      {"render", "a.mp4", "--smoothness", "1"}};
  for (const auto& arguments : wrong) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    const EarlyExit exit = Refused(arguments);
    EXPECT_EQ(exit.exit_code, kExitUsage);
    EXPECT_EQ(exit.output, "");
    EXPECT_THAT(exit.error, StartsWith("rs-stabilize: "));
    EXPECT_THAT(exit.error, HasSubstr("--help"));
  }
}

TEST(CliOptions, EvaluateTakesOneKindOfData) {
  EXPECT_EQ(Parsed({"evaluate", "--clips", "c", "--methods", "input,off"}).evaluate.clips, "c");
  EXPECT_EQ(Parsed({"evaluate", "--pairs", "p", "--protocol", "pairs"}).evaluate.pairs, "p");
  EXPECT_EQ(Parsed({"evaluate", "--dataset", "rs-real:r", "--state", "s"}).evaluate.rs_real, "r");
  EXPECT_THAT(Refused({"evaluate"}).error, HasSubstr("name --dataset, --photos or --clips"));
}

TEST(CliOptions, SimulateTakesTheOptionsOfWhatItMakes) {
  EXPECT_EQ(
      Parsed({"simulate", "s", "--rs-real", "--samples", "3", "--readout", "20"}).simulate.samples,
      3);
  EXPECT_EQ(Parsed({"simulate", "c", "--duration", "3", "--foreground"}).simulate.duration_s, 3.0);
  EXPECT_THAT(Refused({"simulate", "s", "--rs-real", "--fov", "60"}).error, HasSubstr("--fov"));
}

TEST(CliOptions, EvaluateNamesEveryMethod) {
  const std::string help = Refused({"evaluate", "--help"}).output;
  const auto names_in = [](std::string list) {
    std::erase(list, ' ');
    std::set<std::string> names;
    const auto methods = ParseMethodList(list);
    EXPECT_TRUE(methods);
    for (const MethodSpec& method : *methods) {
      names.insert(method.name);
    }
    return names;
  };
  const std::set<std::string> all = names_in(PictureMethodNames());
  EXPECT_TRUE(all.contains("lines"));
  for (const std::string& name : all) {
    EXPECT_THAT(help, ::testing::ContainsRegex("[ \n]" + name + "[ \n]"));  // what it is follows
  }
  for (const std::string& name : ClipMethodNames()) {
    EXPECT_THAT(help, HasSubstr(name));
  }
  std::set<std::string> data_sets = names_in(kDatasetMethods);
  data_sets.insert({"mean", "sample", "regression"});  // as the help says
  EXPECT_EQ(data_sets, all);
}

TEST(CliOptions, HelpFitsATerminalAndNamesEveryOption) {
  for (const CommandText& text : CommandTexts()) {
    std::vector<std::string> arguments = {"--help"};
    if (!text.name.empty()) {
      arguments.insert(arguments.begin(), text.name);
    }
    const EarlyExit exit = Refused(arguments);
    EXPECT_EQ(exit.exit_code, kExitDone);
    std::istringstream lines(exit.output);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), 80U) << line;
    }
    Invocation unused;
    const auto app = MakeCommandApp(text.id, unused);
    for (const CLI::Option* option : app->get_options()) {
      EXPECT_THAT(exit.output, HasSubstr(OptionFlags(*option)));
    }
  }
}

TEST(CliOptions, HelpSaysThatNoGyroLogIsNeeded) {
  EXPECT_THAT(TextOf(CommandId::kStabilize).description, HasSubstr("found from the clip itself"));
  EXPECT_THAT(Refused({"--print-manual"}).output, HasSubstr("found from the clip itself"));
}

TEST(CliOptions, ManualAndCompletionKnowTheOptions) {
  const std::string manual = Refused({"--print-manual"}).output;
  const std::string completion = Refused({"--print-bash-completion"}).output;
  EXPECT_THAT(manual, StartsWith(".TH RS\\-STABILIZE 1"));
  EXPECT_THAT(manual, HasSubstr("\\-\\-gyro\\-offset S"));
  EXPECT_THAT(completion, HasSubstr("--gyro-offset"));
  EXPECT_THAT(completion,
              HasSubstr("--rs) COMPREPLY=($(compgen -W \"auto fused gyro diffusion tracks off\""));
}

TEST(CliOptions, VersionIsOneLine) {
  const EarlyExit exit = Refused({"--version"});
  EXPECT_EQ(exit.exit_code, kExitDone);
  EXPECT_THAT(exit.output, ::testing::MatchesRegex("rs-stabilize [0-9.]+\n"));
}

}  // namespace
}  // namespace rsstab::cli
