// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/gyro_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "igf/gyro_simulator.h"
#include "igf/motion_presets.h"
#include "stabilizer/pipeline/rs_source_selection.h"
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
    WriteLog(kDuration_s + 0.3);
    inputs_.gyro_origin = "log.csv";
    inputs_.camera = Camera::Pinhole(640, 360, 554.0);
    inputs_.camera->readout_s = kReadout_s;
    igf::testing::SyntheticTrackOptions options;
    options.readout_s = kReadout_s;
    tracks_ = igf::testing::MakeTracks(*inputs_.camera, truth_, kDuration_s, options);
  }

  // A log that ends at this time of the clip.
  void WriteLog(double end_s) {
    igf::GyroSimulatorOptions log;
    log.sampling_hz = 500.0;
    log.offset_s = kOffset_s;
    log.noise_rad_s = 0.002;
    inputs_.gyro = *igf::SimulateGyro(truth_, -0.3, end_s, log);
  }

  Result<RsSelection> Select(RsChoice choice, double offset_s) {
    StabilizeOptions options;
    options.rs = choice;
    options.gyro_offset_s = offset_s;
    return SelectGyro(options, WhatIsKnown(options, {640, 360, 30.0}, inputs_), inputs_, tracks_);
  }

  igf::OrientationTrack truth_ =
      *igf::MakePresetOrientation(igf::MotionPreset::kWalking, 3, kDuration_s);
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

// A log of half the clip: auto goes by the tracks if they tell the shutter, gyro keeps the log.
TEST_F(GyroSelection, AutoPrefersTracksToALogWithHoles) {
  stabilizer::ClipCalibration told;
  told.verdict = stabilizer::ShutterVerdict::kRolling;
  told.readout_s = {kReadout_s, 0.1e-3, true};
  stabilizer::ClipCalibration untold;
  StabilizeOptions options;
  const auto source_of = [&](RsChoice choice, const stabilizer::ClipCalibration& calibration) {
    options.rs = choice;
    const auto selection = SelectRsSource(options, {640, 360, 30.0}, inputs_,
                                          {tracks_, calibration, {}}, SilentLogger());
    return selection ? selection->source->Name() : selection.error().message;
  };
  EXPECT_EQ(source_of(RsChoice::kAuto, told), "gyro") << "the log covers the clip";
  WriteLog(0.5 * kDuration_s);
  EXPECT_NEAR(Select(RsChoice::kGyro, kOffset_s)->covered_share, 0.5, 0.05);
  EXPECT_EQ(source_of(RsChoice::kAuto, told), "fused");
  EXPECT_EQ(source_of(RsChoice::kAuto, untold), "gyro") << "half is better than nothing";
  EXPECT_EQ(source_of(RsChoice::kGyro, told), "gyro");
}

// Where tracks show that the camera only turns, nothing follows an object that passes by.
TEST_F(GyroSelection, WhetherTheCameraOnlyTurnsIsWhatTheTracksSay) {
  stabilizer::ClipCalibration tracks_say;
  tracks_say.num_windows = 3;
  StabilizeOptions options;
  options.rs = RsChoice::kGyro;
  const auto only_turns = [&](double parallax_px) {
    tracks_say.parallax_px = parallax_px;
    return SelectRsSource(options, {640, 360, 30.0}, inputs_, {tracks_, tracks_say, {}},
                          SilentLogger())
        ->only_turns;
  };
  EXPECT_TRUE(only_turns(0.5 * stabilizer::kMaxTurningParallax_px));
  EXPECT_FALSE(only_turns(2.0 * stabilizer::kMaxTurningParallax_px));
  tracks_say.num_windows = 0;
  EXPECT_FALSE(only_turns(0.0)) << "nothing was seen";
}

}  // namespace
}  // namespace rsstab::pipeline
