// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands/simulate.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using ::testing::HasSubstr;

// A short simulated clip with a whip of rolling shutter, made once.
class CompareClipsTest : public ::testing::Test {
 protected:
  static constexpr int kFrames = 14;

  static void SetUpTestSuite() {
    folder_ = new rsstab::testing::TemporaryFolder();
    SimulateOptions options;
    options.output = folder_->path().string();
    options.overwrite = true;
    options.motion = igf::MotionPreset::kVibration;
    options.width = 480;
    options.height = 270;
    options.duration_s = kFrames / options.fps;
    const Status status = RunSimulate(options, SilentLogger());
    ASSERT_TRUE(status) << status.error().message;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::string Path(const std::string& name) { return (*folder_ / name).string(); }
  static CompareOptions RsAgainstTwin() {
    CompareOptions options;
    options.input = Path("rs.mp4");
    options.output = Path("gs.mp4");
    options.truth = Path(".");
    options.json = true;
    return options;
  }

  static rsstab::testing::TemporaryFolder* folder_;
};

rsstab::testing::TemporaryFolder* CompareClipsTest::folder_ = nullptr;

TEST_F(CompareClipsTest, TellsRollingShutterFromItsTwin) {
  std::int64_t seen = 0;
  const auto report =
      CompareClips(RsAgainstTwin(), SilentLogger(), [&](std::int64_t done, std::int64_t frames) {
        EXPECT_EQ(done, ++seen);
        EXPECT_EQ(frames, kFrames);
        return true;
      });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(seen, kFrames);
  EXPECT_EQ(report->input.metrics.frames, kFrames);
  EXPECT_EQ(report->output.metrics.frames, kFrames);
  EXPECT_NEAR(report->input.frames_per_second, 30.0, 1e-6);
  // Vibration of the preset bends rows by more than a pixel; the twin is its own truth.
  EXPECT_GT(report->input.truth->camera_residual.value(), 0.7);
  EXPECT_LT(report->output.truth->camera_residual.value(), 0.01);
  EXPECT_GT(report->input.metrics.row_wobble.value(),
            5.0 * report->output.metrics.row_wobble.value());
  EXPECT_NEAR(report->pair.crop.value(), 1.0, 0.01);
}

TEST_F(CompareClipsTest, TruthMayBeNamedByAnyOfItsFiles) {
  for (const char* name : {".", "truth.json", "gs.mp4"}) {
    CompareOptions options = RsAgainstTwin();
    options.truth = Path(name);
    const auto report = CompareClips(options, SilentLogger(),
                                     [](std::int64_t done, std::int64_t) { return done < 2; });
    EXPECT_EQ(report.error().code, ErrorCode::kCancelled) << name << report.error().message;
  }
  CompareOptions options = RsAgainstTwin();
  options.truth = "/nonexistent/truth.json";
  const auto missing = CompareClips(options, SilentLogger());
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("/nonexistent/gs.mp4"));
}

// The truth of another clip with the same motion kind, of `width` x `height` and `frames`.
std::string OtherTruth(const rsstab::testing::TemporaryFolder& folder, int width, int height,
                       int frames) {
  SimulateOptions options;
  options.output = (folder / "other").string();
  options.overwrite = true;
  options.motion = igf::MotionPreset::kVibration;
  options.seed = 9;
  options.width = width;
  options.height = height;
  options.duration_s = frames / options.fps;
  const Status status = RunSimulate(options, SilentLogger());
  EXPECT_TRUE(status) << status.error().message;
  return options.output;
}

TEST_F(CompareClipsTest, TheTruthOfAnotherShapeIsRefused) {
  const rsstab::testing::TemporaryFolder folder;
  CompareOptions options = RsAgainstTwin();
  options.truth = OtherTruth(folder, 270, 480, 3);
  const auto report = CompareClips(options, SilentLogger());
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(report.error().message, HasSubstr("270 x 480"));
  EXPECT_THAT(report.error().message, HasSubstr("480 x 270"));
}

TEST_F(CompareClipsTest, TheTruthOfAnotherClipIsDoubtedAndNothingElsePrinted) {
  const rsstab::testing::TemporaryFolder folder;
  CompareOptions options = RsAgainstTwin();
  for (const int frames : {5, kFrames + 1}) {
    options.truth = OtherTruth(folder, 480, 270, frames);
    std::ostringstream lines;
    const Logger logger = std::make_shared<spdlog::logger>(
        "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines));
    ::testing::internal::CaptureStderr();
    const auto report = CompareClips(options, logger);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(lines.str(),
                HasSubstr(frames < kFrames ? "fewer frames than" : "more frames than"));
  }
}

TEST_F(CompareClipsTest, JsonHoldsEveryFigure) {
  std::ostringstream out;
  CompareOptions options = RsAgainstTwin();
  ASSERT_TRUE(RunCompare(options, SilentLogger(), out));
  const auto json = nlohmann::json::parse(out.str());
  for (const char* clip : {"input", "output"}) {
    for (const char* figure : {"wobble_px", "row_wobble_px", "jitter_px", "shake_px", "stability",
                               "stability_translation", "stability_rotation", "itf_db"}) {
      EXPECT_TRUE(json[clip][figure].is_number()) << clip << " " << figure;
    }
    for (const char* figure : {"camera_residual_px", "bend_px", "worst_frame_px"}) {
      EXPECT_TRUE(json[clip]["truth"][figure].is_number()) << clip << " " << figure;
    }
  }
  for (const char* figure : {"crop_ratio", "distortion_value", "undefined_share"}) {
    EXPECT_TRUE(json["pair"][figure].is_number()) << figure;
  }
}

TEST(CompareReport, FiguresThatWereNotMeasuredAreSaidToBeMissing) {
  const CompareReport report;
  const auto json = nlohmann::json::parse(FormatCompareJson(report));
  EXPECT_TRUE(json["output"]["jitter_px"].is_null());
  EXPECT_TRUE(json["pair"]["crop_ratio"].is_null());
  EXPECT_FALSE(json["output"].contains("truth"));
  EXPECT_THAT(FormatCompareText(report),
              HasSubstr("jitter                  px           -         -"));
}

TEST(CompareReport, TableHasInputAndOutputSideBySide) {
  CompareReport report;
  report.input.metrics.jitter = 4.64;
  report.output.metrics.jitter = 0.5449;
  report.pair.crop = 0.815;
  report.pair.undefined = 0.0125;
  const std::string text = FormatCompareText(report);
  EXPECT_THAT(text, HasSubstr("jitter                  px        4.64      0.54"));
  EXPECT_THAT(text, HasSubstr("crop ratio                       1.000     0.815"));
  EXPECT_THAT(text, HasSubstr("undefined pixels        %        0.000     1.250"));
  EXPECT_THAT(text, HasSubstr("px at 640 px width"));
}

TEST(CompareClips, NamesTheClipThatCannotBeRead) {
  CompareOptions options;
  options.input = "/nonexistent/in.mp4";
  options.output = "/nonexistent/out.mp4";
  const auto report = CompareClips(options, SilentLogger());
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("/nonexistent/in.mp4"));
}

}  // namespace
}  // namespace rsstab::cli
