// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_clips.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/commands/clip_method.h"
#include "cli/commands/evaluate.h"
#include "cli/commands/simulate.h"
#include "igf/base/whole_file.h"
#include "tests/support/test_clip.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using rsstab::testing::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr int kFrames = 15;
constexpr double kReadoutS = 0.02;

// Keeps what would be printed.
EvaluationOutput Into(std::string& table) {
  return [&table](const std::string& text) -> Status {
    table = text;
    return {};
  };
}

// A folder of a simulated clip that vibrates, a real one, and a file that is no clip; made once.
class EvaluateClipsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder();
    SimulateOptions options;
    options.output = (*folder_ / "vibration").string();
    options.motion = igf::MotionPreset::kVibration;
    options.readout_s = kReadoutS;
    options.width = 480;
    options.height = 270;
    options.duration_s = kFrames / options.fps;
    const Status status = RunSimulate(options, SilentLogger());
    ASSERT_TRUE(status) << status.error().message;
    rsstab::testing::WriteTestClip(*folder_ / "real.mkv");
    ASSERT_TRUE(WriteWholeFile((*folder_ / "broken.mp4").string(), "no clip"));
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static EvaluateOptions Options(const std::string& clips, const std::string& methods) {
    EvaluateOptions options;
    options.clips = (*folder_ / clips).string();
    options.methods = methods;
    return options;
  }

  static TemporaryFolder* folder_;
};

TemporaryFolder* EvaluateClipsTest::folder_ = nullptr;

const ClipRun& RunOf(const ClipRecord& clip, const std::string& method) {
  const auto run = std::find_if(clip.runs.begin(), clip.runs.end(), [&](const ClipRun& candidate) {
    return candidate.method == method;
  });
  EXPECT_NE(run, clip.runs.end()) << method;
  return *run;
}

TEST_F(EvaluateClipsTest, TruthTellsTheMethodsApart) {
  EvaluateOptions options = Options("vibration", "input,off,gyro,auto");
  options.twins = true;
  const auto report = EvaluateClips(options, SilentLogger());
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->clips.size(), 2U);

  const ClipRecord& clip = report->clips[0];
  EXPECT_EQ(clip.readout_s, kReadoutS);
  const ClipRun& input = RunOf(clip, "input");
  const ClipRun& off = RunOf(clip, "off");
  const ClipRun& gyro = RunOf(clip, "gyro");
  const double residual = input.clip.truth->camera_residual.value();
  ASSERT_GT(residual, 0.7);
  EXPECT_FALSE(input.pair);
  EXPECT_FALSE(input.field);
  EXPECT_EQ(input.clip.metrics.frames, kFrames);
  // The log and the camera are exact, so that little is left but the noise of encoding.
  EXPECT_LT(gyro.clip.truth->camera_residual.value(), 0.2 * residual);
  EXPECT_LT(gyro.field->epe_px.value(), 0.02 * gyro.field->uncorrected_epe_px.value());
  EXPECT_GT(gyro.field->applied_px, 0.7);
  EXPECT_NEAR(gyro.readout_s.value(), kReadoutS, 1e-9);
  EXPECT_EQ(gyro.rs_source, "gyro");
  // The rotation is read from the log.
  EXPECT_EQ(gyro.angle->known_share, 1.0);
  EXPECT_GT(gyro.angle->uncorrected_rate_deg_s.value(), 5.0);
  EXPECT_LT(gyro.angle->angle_deg.value(), 0.02 * gyro.angle->uncorrected_angle_deg.value());
  EXPECT_LT(gyro.angle->rate_deg_s.value(), 0.02 * *gyro.angle->uncorrected_rate_deg_s);
  EXPECT_FALSE(input.angle);
  EXPECT_FALSE(off.angle->angle_deg);
  EXPECT_EQ(off.angle->uncorrected_rate_deg_s, gyro.angle->uncorrected_rate_deg_s);
  // Nothing is corrected, so all of it is left.
  EXPECT_EQ(off.field->applied_px, 0.0);
  EXPECT_DOUBLE_EQ(off.field->epe_px.value(), off.field->uncorrected_epe_px.value());
  EXPECT_DOUBLE_EQ(off.field->uncorrected_epe_px.value(), *gyro.field->uncorrected_epe_px);
  EXPECT_LT(off.clip.metrics.shake.value(), input.clip.metrics.shake.value());
  EXPECT_GT(off.pair->crop.value(), 0.75);
  EXPECT_GT(off.analysis_ms.value(), 0.0);
  EXPECT_DOUBLE_EQ(off.total_ms.value(), *off.analysis_ms + off.render_ms.value());
  EXPECT_DOUBLE_EQ(off.own_ms.value(),
                   *off.total_ms - clip.decode_ms.value() - clip.recode_ms.value());

  const ClipRecord& twin = report->clips[1];
  EXPECT_EQ(twin.name, "vibration/gs");
  EXPECT_EQ(twin.readout_s, 0.0);
  EXPECT_LT(RunOf(twin, "input").clip.truth->camera_residual.value(), 0.01);
  EXPECT_EQ(RunOf(twin, "gyro").field->applied_px, 0.0);
  EXPECT_EQ(RunOf(twin, "gyro").field->uncorrected_epe_px, 0.0);
}

TEST_F(EvaluateClipsTest, ReportsHoldEveryFigure) {
  EvaluateOptions options = Options(".", "input,off@smoothness=0.5");
  std::int64_t seen = 0;
  const auto report =
      EvaluateClips(options, SilentLogger(), [&](std::int64_t done, std::int64_t all) {
        EXPECT_GT(done, seen);
        EXPECT_EQ(all, 6);
        seen = done;
        return true;
      });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(seen, 6);

  const Json json = Json::parse(FormatJson(*report));
  EXPECT_EQ(json["protocol"], "clips");
  EXPECT_EQ(json["settings"]["protocol"], "clips");
  EXPECT_EQ(json["samples"], 2);
  EXPECT_EQ(json["left_out"][0]["name"], "broken.mp4");
  EXPECT_EQ(json["clips"][0]["name"], "real.mkv");
  EXPECT_EQ(json["clips"][1]["name"], "vibration");
  EXPECT_EQ(json["clips"][1]["true_readout_ms"], 20.0);
  const Json& off = json["clips"][1]["methods"]["off@smoothness=0.5"];
  for (const char* figure : {"wobble_px",
                             "row_wobble_px",
                             "jitter_px",
                             "shake_px",
                             "stability",
                             "stability_translation",
                             "stability_rotation",
                             "crop_ratio",
                             "smallest_crop_ratio",
                             "distortion_value",
                             "undefined_percent",
                             "worst_undefined_percent",
                             "itf_db",
                             "rs_field_px",
                             "camera_residual_px",
                             "worst_frame_px",
                             "bend_px",
                             "rs_epe_px",
                             "rs_epe_uncorrected_px",
                             "path_angle_uncorrected_deg",
                             "path_rate_uncorrected_deg_s",
                             "path_known_percent",
                             "analysis_ms",
                             "render_ms",
                             "total_ms",
                             "own_ms"}) {
    EXPECT_TRUE(off[figure].is_number()) << figure;
  }
  EXPECT_TRUE(off["path_angle_deg"].is_null());
  EXPECT_TRUE(off["readout_ms"].is_null());  // no source, so none was found
  EXPECT_EQ(off["rs_source"], "none");
  EXPECT_EQ(off["frames"], kFrames);
  EXPECT_TRUE(json["clips"][0]["methods"]["input"]["camera_residual_px"].is_null());
  EXPECT_EQ(json["means"]["simulated"]["off@smoothness=0.5"]["jitter_px"], off["jitter_px"]);
  EXPECT_EQ(json["means"]["simulated"]["input"]["clips"], 1);

  const std::string text = FormatText(*report);
  EXPECT_THAT(text, HasSubstr("left out: broken.mp4: "));
  EXPECT_THAT(text, HasSubstr("vibration: simulated, readout 20.0 ms, 480x270, 15 frames"));
  EXPECT_THAT(text, HasSubstr("\noff@smoothness=0.5 "));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_THAT(text, Not(HasSubstr("mean of")));  // there is one clip of each kind

  const std::string csv = FormatCsv(*report);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 4);
  EXPECT_THAT(csv, HasSubstr("\nvibration,simulated,input,15,20,"));
  const auto columns = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  std::istringstream lines(csv);
  std::string head;
  std::getline(lines, head);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(columns(line), columns(head)) << line;
  }
}

TEST_F(EvaluateClipsTest, MeansAreOverTheClipsOfAKind) {
  ClipsReport report;
  report.methods = {"off"};
  for (const double jitter : {1.0, 2.0, 6.0}) {
    ClipRecord clip;
    clip.name = "clip";
    clip.runs.emplace_back();
    clip.runs.back().method = "off";
    clip.runs.back().clip.metrics.jitter = jitter;
    report.clips.push_back(clip);
  }
  report.clips.back().kind = ClipKind::kTwin;
  const Json json = Json::parse(FormatJson(report));
  EXPECT_EQ(json["means"]["real"]["off"]["jitter_px"], 1.5);
  EXPECT_EQ(json["means"]["real"]["off"]["clips"], 2);
  EXPECT_EQ(json["means"]["twin"]["off"]["jitter_px"], 6.0);
  EXPECT_TRUE(json["means"]["real"]["off"]["itf_db"].is_null());
  EXPECT_THAT(FormatText(report), HasSubstr("mean of 2 real clips"));
}

// A clip without a truth, but with a log that one of the methods reads.
TEST_F(EvaluateClipsTest, ALogStandsInForTheTrueRotation) {
  const TemporaryFolder real;
  std::filesystem::copy_file(*folder_ / "vibration" / "rs.mp4", real / "clip.mp4");
  const std::string known =
      "camera=" + (*folder_ / "vibration" / "camera.json").string() + ",readout=20";
  const std::string gyro =
      "gyro@gyro-offset=0," + known + ",gyro=" + (*folder_ / "vibration" / "gyro.csv").string();
  const std::string tracks = "tracks@" + known;
  EvaluateOptions options = Options("", "input," + tracks + "," + gyro);
  options.clips = real.path().string();
  const auto report = EvaluateClips(options, SilentLogger());
  ASSERT_TRUE(report) << report.error().message;
  const ClipRecord& clip = report->clips.front();
  EXPECT_EQ(clip.kind, ClipKind::kReal);
  EXPECT_FALSE(RunOf(clip, "input").angle);
  EXPECT_FALSE(RunOf(clip, gyro).angle);  // against itself
  const auto& angle = RunOf(clip, tracks).angle;
  ASSERT_TRUE(angle && angle->rate_deg_s);
  EXPECT_LT(*angle->rate_deg_s, 0.1 * angle->uncorrected_rate_deg_s.value());
  EXPECT_THAT(FormatText(*report), HasSubstr("angle in"));
  // Nobody knows it of the other real clip, and so its table has no such columns.
  EXPECT_THAT(FormatText(*EvaluateClips(Options(".", "off"), SilentLogger())),
              ::testing::ContainsRegex("real.mkv.*\n.*RS readout analysis"));
}

TEST_F(EvaluateClipsTest, WhatFailsIsNamedAndTheRestGoesOn) {
  // The real clip has no log, the broken one is none.
  const auto report = EvaluateClips(Options(".", "gyro,off"), SilentLogger());
  ASSERT_TRUE(report) << report.error().message;
  std::vector<std::string> names;
  for (const auto& [name, error] : report->header.failures) {
    names.push_back(name);
  }
  EXPECT_THAT(names, ElementsAre("broken.mp4", "real.mkv, gyro"));
  EXPECT_EQ(report->clips[0].runs.size(), 1U);
  EXPECT_EQ(report->clips[1].runs.size(), 2U);
}

TEST_F(EvaluateClipsTest, MistakesAreErrors) {
  const TemporaryFolder empty;
  const auto message = [](const EvaluateOptions& options) {
    std::string table;
    const Status status = RunEvaluate(options, SilentLogger(), Into(table));
    EXPECT_FALSE(status);
    return status ? "" : status.error().message;
  };
  EXPECT_THAT(message(Options(".", "input,magic")), HasSubstr("'magic'; choose from input, auto"));
  EvaluateOptions options = Options(".", "input");
  options.clips = empty.path().string();
  EXPECT_THAT(message(options), HasSubstr("there is no clip in this folder"));
  options.clips.clear();
  options.protocol = EvaluationProtocol::kClips;
  EXPECT_THAT(message(options), HasSubstr("--clips"));
  std::filesystem::copy_file(*folder_ / "broken.mp4", empty / "broken.mp4");
  options.clips = empty.path().string();
  EXPECT_THAT(message(options), HasSubstr("broken.mp4 is left out"));
}

TEST_F(EvaluateClipsTest, StopsWhenAsked) {
  const auto report = EvaluateClips(Options("vibration", "input,off"), SilentLogger(),
                                    [](std::int64_t, std::int64_t) { return false; });
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kCancelled);
}

TEST_F(EvaluateClipsTest, FfmpegsToolsKeepEveryFrame) {
  if (WhyToolIsMissing(ClipTool::kVidstab) || WhyToolIsMissing(ClipTool::kDeshake)) {
    GTEST_SKIP() << "there is no ffmpeg with vid.stab and deshake here";
  }
  const auto report = EvaluateClips(Options("vibration", "vidstab,deshake"), SilentLogger());
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_TRUE(report->header.failures.empty()) << report->header.failures.front().second.message;
  for (const ClipRun& run : report->clips[0].runs) {
    EXPECT_EQ(run.clip.metrics.frames, kFrames) << run.method;
    EXPECT_TRUE(run.clip.truth->camera_residual) << run.method;
    EXPECT_GT(run.total_ms.value(), 0.0) << run.method;
    EXPECT_FALSE(run.field) << run.method;
  }
  EXPECT_TRUE(RunOf(report->clips[0], "vidstab").analysis_ms);
  EXPECT_FALSE(RunOf(report->clips[0], "deshake").analysis_ms);
}

}  // namespace
}  // namespace rsstab::cli
