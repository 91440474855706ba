// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/gyro_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "igf/gyro_simulator.h"
#include "igf/motion_presets.h"
#include "tests/igf/synthetic_tracks.h"

namespace rsstab::pipeline {
namespace {

using ::testing::HasSubstr;

constexpr double kDuration_s = 4.0;
constexpr double kOffset_s = 0.3;
constexpr double kReadout_s = 0.020;
constexpr double kTolerance_s = 0.5e-3;  // tenth of the error that is to be found

class GyroSelection : public ::testing::Test {
 protected:
  GyroSelection() {
    const auto truth = *igf::MakePresetOrientation(igf::MotionPreset::kWalking, 3, kDuration_s);
    igf::GyroSimulatorOptions log;
    log.sampling_hz = 500.0;
    log.offset_s = kOffset_s;
    log.noise_rad_s = 0.002;
    inputs_.gyro = *igf::SimulateGyro(truth, -0.3, kDuration_s + 0.3, log);
    inputs_.gyro_origin = "log.csv";
    inputs_.camera = Camera::Pinhole(640, 360, 554.0);
    inputs_.camera->readout_s = kReadout_s;
    igf::testing::SyntheticTrackOptions options;
    options.readout_s = kReadout_s;
    tracks_ = igf::testing::MakeTracks(*inputs_.camera, truth, kDuration_s, options);
  }

  Result<RsSelection> Select(RsChoice choice, double offset_s) {
    StabilizeOptions options;
    options.rs = choice;
    options.gyro_offset_s = offset_s;
    return SelectGyro(options, WhatIsKnown(options, {640, 360, 30.0}, inputs_), inputs_, tracks_);
  }

  RsInputs inputs_;
  std::vector<PointTracks> tracks_;
};

TEST_F(GyroSelection, AutoMovesAnOffsetThatIsClearlyWrong) {
  for (const double error_s : {-0.005, 0.005, 0.015}) {
    const auto selection = Select(RsChoice::kAuto, kOffset_s + error_s);
    ASSERT_TRUE(selection) << selection.error().message;
    EXPECT_NEAR(*selection->gyro_offset_s, kOffset_s, kTolerance_s);
    EXPECT_THAT(selection->reason, HasSubstr("moved"));
  }
}

TEST_F(GyroSelection, AnOffsetFarFromWhatTheTracksSayIsTheUsersOwn) {
  const auto selection = Select(RsChoice::kAuto, kOffset_s + 0.2);
  ASSERT_TRUE(selection) << selection.error().message;
  EXPECT_EQ(selection->gyro_offset_s, kOffset_s + 0.2);
}

TEST_F(GyroSelection, GyroKeepsTheOffsetToTheLastBit) {
  const auto selection = Select(RsChoice::kGyro, kOffset_s + 0.005);
  ASSERT_TRUE(selection) << selection.error().message;
  EXPECT_EQ(selection->gyro_offset_s, kOffset_s + 0.005);
}

TEST_F(GyroSelection, TheReadoutTheTracksGiveIsTold) {
  inputs_.camera->readout_s.reset();
  const auto selection = Select(RsChoice::kAuto, kOffset_s);
  ASSERT_TRUE(selection) << selection.error().message;
  ASSERT_TRUE(selection->calibration);
  EXPECT_EQ(selection->calibration->verdict, stabilizer::ShutterVerdict::kRolling);
  EXPECT_NEAR(selection->calibration->readout_s.value, kReadout_s, 0.05 * kReadout_s);
  EXPECT_GT(selection->calibration->readout_s.sigma, 0.0);
  EXPECT_TRUE(selection->calibration->focal.trusted);
}

}  // namespace
}  // namespace rsstab::pipeline
