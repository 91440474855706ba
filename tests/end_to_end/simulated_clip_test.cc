// SPDX-License-Identifier: Apache-2.0
// The program's main promise, against known truth: simulate, steady with the gyro log, compare.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/end_to_end/program.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

// px at 640 px width. The tracker's floor on these clips is about 0.1, uncorrected clips show 0.5
// to 2.2.
constexpr double kMaxCameraResidual = 0.2;
// The vibration clip has 7 px before.
constexpr double kMaxJitter = 0.3;
// Share of pixels. The measurement aligns two pictures, and is off by a few pixels at an edge.
constexpr double kUndefinedNoise = 1e-4;

class SimulatedClip : public ::testing::TestWithParam<const char*> {
 protected:
  void Simulate(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"simulate", Path("sim"), "--motion", GetParam(),
                                          "--width",  "640",       "--height", "360"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOrFail(arguments);
  }
  nlohmann::json Compare() {
    return nlohmann::json::parse(RunOrFail({"compare", Path("sim/rs.mp4"), Path("out.mp4"),
                                            "--truth", Path("sim"), "--json"})
                                     .output);
  }
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

TEST_P(SimulatedClip, GyroRemovesRollingShutterAndShake) {
  Simulate({"--duration", "2"});
  RunOrFail({Path("sim/rs.mp4"), "-o", Path("out.mp4"), "--rs", "gyro", "--gyro",
             Path("sim/gyro.csv"), "--camera", Path("sim/camera.json")});
  const nlohmann::json report = Compare();
  EXPECT_EQ(report["output"]["frames"], report["input"]["frames"]);
  EXPECT_LT(report["output"]["truth"]["camera_residual_px"], kMaxCameraResidual);
  if (GetParam() == std::string("vibration")) {
    EXPECT_LT(report["output"]["jitter_px"], kMaxJitter);
  }
  EXPECT_LT(report["pair"]["undefined_share"], kUndefinedNoise);
}

TEST_P(SimulatedClip, OffsetAndReadoutAreFound) {
  Simulate({"--duration", "6", "--gyro-offset", "1.234", "--gyro-bias", "0.01", "--gyro-noise",
            "0.002"});
  // The focal length is told, readout and offset are not.
  const nlohmann::json camera = nlohmann::json::parse(ReadText(Path("sim/camera.json")));
  const std::string error =
      RunOrFail({Path("sim/rs.mp4"), "-o", Path("out.mp4"), "--rs", "gyro", "--gyro",
                 Path("sim/gyro.csv"), "--focal", std::to_string(camera["fx"].get<double>())})
          .error;
  // "offset 1234.0 ms, readout 20.0 ms (estimated)"
  const double offset_ms = NumberAfter(error, "offset ");
  const double readout_ms = NumberAfter(error, "readout ");
  const double true_readout_ms = camera["readout_s"].get<double>() * 1e3;
  EXPECT_NEAR(offset_ms, 1234.0, 2.0);
  EXPECT_NEAR(readout_ms, true_readout_ms, 0.05 * true_readout_ms);
}

INSTANTIATE_TEST_SUITE_P(Presets, SimulatedClip,
                         ::testing::Values("handheld", "walking", "vibration", "fast-pan"),
                         [](const auto& preset) {
                           std::string name = preset.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

}  // namespace
}  // namespace rsstab::testing
