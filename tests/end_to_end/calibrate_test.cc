// SPDX-License-Identifier: Apache-2.0
// What `calibrate` says of cameras that are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/end_to_end/program.h"
#include "tests/support/test_clip.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

using ::testing::HasSubstr;

// Promised wherever the camera moves enough; twice that is an error, not bad luck.
constexpr double kMaxReadoutError = 0.1;
constexpr double kMaxFocalError = 0.06;  // twice the sigma up to which it is trusted

class CalibrateClip : public ::testing::Test {
 protected:
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }
  void Simulate(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"simulate", Path("sim"), "--width",    "640",
                                          "--height", "360",       "--duration", "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOrFail(arguments);
  }
  nlohmann::json Calibrate(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"calibrate", Path("sim/rs.mp4"), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return nlohmann::json::parse(RunOrFail(arguments).output);
  }

 private:
  TemporaryFolder folder_;
};

void ExpectReadout(const nlohmann::json& found, double true_readout_s) {
  EXPECT_EQ(found["verdict"], "rolling");
  EXPECT_EQ(found["readout_s"]["trusted"], true);
  EXPECT_NEAR(found["readout_s"]["value"].get<double>(), true_readout_s,
              kMaxReadoutError * std::abs(true_readout_s));
  EXPECT_LT(found["readout_s"]["low"], found["readout_s"]["value"]);
  EXPECT_GT(found["readout_s"]["high"], found["readout_s"]["value"]);
  EXPECT_GE(found["stretches"], 1);
}

TEST_F(CalibrateClip, FindsTheReadoutAndSavesTheCamera) {
  Simulate({"--motion", "walking", "--readout", "20"});
  const auto found = Calibrate({"-o", Path("camera.json"), "--curves", Path("curves.svg")});
  ExpectReadout(found, 0.020);
  EXPECT_TRUE(found["gyro_offset_s"].is_null());
  const auto truth = nlohmann::json::parse(ReadText(Path("sim/camera.json")));
  if (found["focal_px"]["trusted"].get<bool>()) {
    EXPECT_NEAR(found["focal_px"]["value"].get<double>(), truth["fx"].get<double>(),
                kMaxFocalError * truth["fx"].get<double>());
  }
  const auto camera = nlohmann::json::parse(ReadText(Path("camera.json")));
  EXPECT_EQ(camera["readout_s"], found["readout_s"]["value"]);
  EXPECT_EQ(camera["readout_sigma_s"], found["readout_s"]["sigma"]);
  EXPECT_EQ(camera["focal_sigma_px"], found["focal_px"]["sigma"]);
  EXPECT_THAT(ReadText(Path("curves.svg")), HasSubstr("tracks"));

  // The file is not replaced unasked, and serves as --camera.
  const ProgramResult again =
      RunRsStabilize({"calibrate", Path("sim/rs.mp4"), "-o", Path("camera.json")});
  EXPECT_NE(again.exit_code, 0);
  const auto given = Calibrate({"--camera", Path("camera.json")});
  EXPECT_EQ(given["verdict"], "given");
  EXPECT_EQ(given["readout_s"]["value"], camera["readout_s"]);
}

TEST_F(CalibrateClip, TellsTheDirection) {
  Simulate({"--motion", "walking", "--readout", "-15"});
  ExpectReadout(Calibrate(), -0.015);
}

TEST_F(CalibrateClip, SeesThatAShutterIsGlobal) {
  Simulate({"--motion", "walking", "--readout", "0"});
  const auto found = Calibrate();
  EXPECT_EQ(found["verdict"], "global");
  EXPECT_EQ(found["readout_s"]["value"], 0.0);
}

TEST_F(CalibrateClip, SaysWhenNothingMoves) {
  std::filesystem::create_directory(Path("sim"));
  TestClip clip;
  clip.frames = 45;
  clip.shake_px = 0.0;
  WriteTestClip(Path("sim/rs.mp4"), clip);
  const auto found = Calibrate({"-o", Path("camera.json")});
  EXPECT_EQ(found["verdict"], "unknown");
  EXPECT_EQ(found["readout_s"]["trusted"], false);
  EXPECT_THAT(found["readout_s"]["reason"].get<std::string>(), HasSubstr("--readout"));
  EXPECT_EQ(nlohmann::json::parse(ReadText(Path("camera.json")))["trusted"], false);
}

TEST_F(CalibrateClip, AGyroLogTellsMore) {
  Simulate({"--motion", "walking", "--readout", "20", "--gyro-offset", "0.3", "--gyro-noise",
            "0.002", "--gyro-bias", "0.01"});
  const auto found = Calibrate({"--gyro", Path("sim/gyro.csv")});
  ExpectReadout(found, 0.020);
  EXPECT_EQ(found["gyro_offset_s"]["trusted"], true);
  EXPECT_NEAR(found["gyro_offset_s"]["value"].get<double>(), 0.3, 2e-3);
  EXPECT_LT(found["gyro_offset_s"]["low"], 0.301);
}

}  // namespace
}  // namespace rsstab::testing
