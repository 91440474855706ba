// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace rsstab::cli {
namespace {

using pipeline::CalibrationReport;
using stabilizer::ShutterVerdict;
using ::testing::HasSubstr;
using ::testing::Not;

CalibrationReport Upwards() {
  CalibrationReport report;
  report.verdict = ShutterVerdict::kRolling;
  report.readout_s = {-0.015, 0.0005, true, false, ""};
  report.focal_px = {512.0, 76.8, false, false, "it moves past near things"};
  report.camera = Camera::Pinhole(640, 360, 512.0);
  report.camera.readout_s = -0.015;
  report.num_stretches = 3;
  report.tracks_readout_s = stabilizer::Estimate{-0.0148, 0.0006, true};
  report.pictures.emplace();
  report.pictures->readout_s = -0.0155;
  report.pictures->sigma_s = 0.002;
  report.curves.push_back({"tracks", {{-0.02, -12.5}, {-0.01, 0.0}, {0.0, -50.0}}});
  return report;
}

TEST(Calibrate, TextTellsIntervalsTrustAndDirection) {
  const std::string text = FormatCalibrationText(Upwards(), "clip.mp4");
  EXPECT_THAT(text, HasSubstr("clip.mp4"));
  EXPECT_THAT(text, HasSubstr("rolling shutter, read from bottom to top"));
  EXPECT_THAT(text, HasSubstr("-15.00 ms, 95 % between -15.98 and -14.02 ms\n"));
  EXPECT_THAT(text, HasSubstr("512.0 px, 95 % between 361.5 and 662.5 px\n"));
  EXPECT_THAT(text, HasSubstr("not trusted: it moves past near things"));
  EXPECT_THAT(text, HasSubstr("tracks alone: -14.80 +- 0.60 ms"));
  EXPECT_THAT(text, HasSubstr("single images alone: -15.50 +- 2.00 ms"));
  EXPECT_THAT(text, HasSubstr("3 stretches"));
  EXPECT_THAT(text, HasSubstr("-10.0 ms"));  // the curve
  EXPECT_THAT(text, Not(HasSubstr("gyro")));

  CalibrationReport with_log = Upwards();
  with_log.gyro_offset_s = {0.25, 0.0001, true, false, ""};
  EXPECT_THAT(FormatCalibrationText(with_log, "clip.mp4"),
              HasSubstr("gyro offset   250.00 ms, 95 % between 249.80 and 250.20 ms"));
  with_log.gyro_offset_s.emplace().reason = "the log does not fit";
  EXPECT_THAT(FormatCalibrationText(with_log, "clip.mp4"),
              HasSubstr("gyro offset   not found: the log does not fit"));
}

TEST(Calibrate, TextTellsWhatIsGivenAndWhatIsNotThere) {
  CalibrationReport report;
  report.verdict = ShutterVerdict::kGiven;
  report.readout_s = {0.02, 0.0, true, true, ""};
  report.focal_px = {512.0, 0.0, false, false, "nothing turns"};
  const std::string text = FormatCalibrationText(report, "clip.mp4");
  EXPECT_THAT(text, HasSubstr("20.00 ms (given)"));
  // Nobody knows how far off a guess is: no interval.
  EXPECT_THAT(text, Not(HasSubstr("95 %")));
  report.verdict = ShutterVerdict::kCannotBeTold;
  EXPECT_THAT(FormatCalibrationText(report, "clip.mp4"), HasSubstr("cannot be told"));
  report.verdict = ShutterVerdict::kGlobal;
  EXPECT_THAT(FormatCalibrationText(report, "clip.mp4"), HasSubstr("no rolling shutter"));
}

TEST(Calibrate, JsonHoldsTheSame) {
  const auto json = nlohmann::json::parse(FormatCalibrationJson(Upwards(), "clip.mp4"));
  EXPECT_EQ(json["verdict"], "rolling");
  EXPECT_EQ(json["readout_s"]["value"], -0.015);
  EXPECT_NEAR(json["readout_s"]["low"].get<double>(), -0.015 - 1.96 * 0.0005, 1e-12);
  EXPECT_NEAR(json["readout_s"]["high"].get<double>(), -0.015 + 1.96 * 0.0005, 1e-12);
  EXPECT_EQ(json["readout_s"]["trusted"], true);
  EXPECT_EQ(json["focal_px"]["trusted"], false);
  EXPECT_EQ(json["focal_px"]["reason"], "it moves past near things");
  EXPECT_EQ(json["tracks_readout_s"]["value"], -0.0148);
  EXPECT_EQ(json["pictures_readout_s"]["sigma"], 0.002);
  EXPECT_TRUE(json["gyro_offset_s"].is_null());
  EXPECT_EQ(json["stretches"], 3);
  ASSERT_EQ(json["curves"].size(), 1U);
  EXPECT_EQ(json["curves"][0]["source"], "tracks");
  EXPECT_EQ(json["curves"][0]["points"][1]["readout_s"], -0.01);
  EXPECT_EQ(json["curves"][0]["points"][1]["log_evidence"], 0.0);
}

TEST(Calibrate, ChartShowsEachSourceTheValueAndItsInterval) {
  CalibrationReport report = Upwards();
  report.curves.push_back({"single images", {{-0.02, -1.0}, {0.0, -2.0}}});
  const std::string svg = FormatCalibrationChart(report);
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("tracks"));
  EXPECT_THAT(svg, HasSubstr("single images"));
  EXPECT_THAT(svg, HasSubstr("-15.00 ms"));
  EXPECT_THAT(svg, HasSubstr("95 %"));
  report.readout_s.trusted = false;
  EXPECT_THAT(FormatCalibrationChart(report), Not(HasSubstr("-15.00 ms")));
}

TEST(Calibrate, CameraFileKeepsWhatCannotBeTrustedApart) {
  const auto profile =
      igf::ParseCameraJson(igf::FormatCameraJson(pipeline::ToCalibratedCamera(Upwards())));
  ASSERT_TRUE(profile) << profile.error().message;
  EXPECT_EQ(profile->camera.readout_s, -0.015);
  EXPECT_FALSE(profile->focal_is_known);
}

}  // namespace
}  // namespace rsstab::cli
