// SPDX-License-Identifier: Apache-2.0
#include "igf/simulation_truth.h"

#include <gtest/gtest.h>

#include <string>

#include "igf/base/rolling_shutter.h"
#include "igf/base/rotation.h"
#include "igf/motion_presets.h"

namespace rsstab::igf {
namespace {

SimulationTruth ExampleTruth() {
  SimulationTruth truth{Camera::Pinhole(320, 180, 277.0),
                        0.0,
                        0.3,
                        {},
                        *MakePresetOrientation(MotionPreset::kVibration, 2, 1.0)};
  truth.camera.readout_s = -0.028;
  for (int n = 0; n < 30; ++n) {
    truth.frame_times_s.push_back(n / 30.0);
  }
  return truth;
}

TEST(SimulationTruth, EveryRowComesBackExactly) {
  const SimulationTruth truth = ExampleTruth();
  const auto text = FormatSimulationTruth(truth, 0.0);
  ASSERT_TRUE(text) << text.error().message;
  const auto read = ParseSimulationTruth(*text);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->frame_times_s, truth.frame_times_s);
  EXPECT_EQ(read->camera.readout_s, truth.camera.readout_s);
  EXPECT_EQ(read->camera.width, 320);
  EXPECT_EQ(read->camera.fx, truth.camera.fx);
  EXPECT_EQ(read->gyro_offset_s, 0.3);
  constexpr double kRoundOff = 1e-12;
  for (const double time_s : truth.frame_times_s) {
    for (int row = 0; row < 180; row += 179) {
      const double t = RowExposureTime(time_s, static_cast<double>(row), 180, -0.028);
      const auto expected = truth.orientation.CameraFromWorld(t);
      const auto actual = read->orientation.CameraFromWorld(t);
      ASSERT_TRUE(expected && actual) << t;
      EXPECT_LT((expected->coeffs() - actual->coeffs()).norm(), kRoundOff);
    }
  }
}

TEST(SimulationTruth, RefusesATrackThatIsTooShort) {
  SimulationTruth truth = ExampleTruth();
  truth.frame_times_s.push_back(5.0);
  EXPECT_FALSE(FormatSimulationTruth(truth));
  truth.frame_times_s.clear();
  EXPECT_FALSE(FormatSimulationTruth(truth));
}

TEST(SimulationTruth, RefusesDamage) {
  const auto text = FormatSimulationTruth(ExampleTruth());
  ASSERT_TRUE(text);
  EXPECT_FALSE(ParseSimulationTruth(""));
  EXPECT_FALSE(ParseSimulationTruth("[1, 2]"));
  EXPECT_FALSE(ParseSimulationTruth(text->substr(0, text->size() / 2)));
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string damaged = *text;
    damaged.replace(damaged.find(from), from.size(), to);
    return ParseSimulationTruth(damaged);
  };
  EXPECT_FALSE(replaced("\"version\":1", "\"version\":2"));
  EXPECT_FALSE(replaced("\"times_s\":[", "\"times_s\":[9e9,"));
  EXPECT_FALSE(replaced("\"width\":320", "\"width\":-320"));
  EXPECT_FALSE(replaced("\"world_from_camera\":[[", "\"world_from_camera\":[[]],\"x\":[["));
}

}  // namespace
}  // namespace rsstab::igf
