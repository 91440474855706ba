// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_simulator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "igf/base/rotation.h"
#include "igf/gyro_integrator.h"
#include "igf/motion_presets.h"

namespace rsstab::igf {
namespace {

constexpr double kDurationS = 4.0;

// Angle between the turns that two tracks make from time_0 to time_1, rad.
double TurnError(const OrientationTrack& a, const OrientationTrack& b, double time_0_s,
                 double time_1_s) {
  const auto turn = [&](const OrientationTrack& track) -> Eigen::Quaterniond {
    return *track.CameraFromWorld(time_1_s) * track.CameraFromWorld(time_0_s)->conjugate();
  };
  return LogSo3(Eigen::Quaterniond(turn(a) * turn(b).conjugate())).norm();
}

// A whole window between samples: the product of the increments is the track itself.
TEST(SimulateGyro, FullWindowsMultiplyToTheTrack) {
  constexpr double kRoundOff = 1e-9;  // over thousands of products
  for (const double sampling_hz : {200.0, 397.5, 1000.0}) {
    const auto track = MakePresetOrientation(MotionPreset::kVibration, 1, kDurationS);
    ASSERT_TRUE(track);
    GyroSimulatorOptions options;
    options.sampling_hz = sampling_hz;
    options.averaging_s = 1.0 / sampling_hz;
    const auto log = SimulateGyro(*track, 0.0, kDurationS, options);
    ASSERT_TRUE(log) << log.error().message;
    Eigen::Quaterniond q = track->CameraFromWorld(-0.5 / sampling_hz)->conjugate();
    for (const GyroSample& sample : log->samples()) {
      q = q * ExpSo3(Eigen::Vector3d(sample.rate_rad_s / sampling_hz));
      const auto truth = track->CameraFromWorld(sample.time_s + 0.5 / sampling_hz);
      ASSERT_TRUE(truth);
      ASSERT_LT(LogSo3(Eigen::Quaterniond(*truth * q)).norm(), kRoundOff) << sample.time_s;
    }
  }
}

// The product's own integrator, which takes samples for momentary rates, must find the motion, too.
TEST(SimulateGyro, IntegratesToTheTrack) {
  constexpr double kTolerance = 1e-5;  // rad over one frame; 0.006 px at 640 px width
  for (const MotionPreset preset : kMotionPresets) {
    const auto track = MakePresetOrientation(preset, 1, kDurationS);
    ASSERT_TRUE(track);
    const auto log = SimulateGyro(*track, -0.2, kDurationS + 0.2);
    ASSERT_TRUE(log) << log.error().message;
    // Steps as short as the track's, so that SLERP between them costs nothing.
    GyroIntegrationOptions fine;
    fine.max_step_s = 1.0 / kPresetSamplingHz;
    const auto integrated = IntegrateGyro(*log, fine);
    ASSERT_TRUE(integrated) << integrated.error().message;
    for (int n = 0; n < 119; ++n) {
      EXPECT_LT(TurnError(*track, *integrated, n / 30.0, (n + 1) / 30.0), kTolerance)
          << MotionPresetName(preset) << " " << n;
      EXPECT_LT(TurnError(*track, *integrated, n / 30.0, n / 30.0 + 0.012), kTolerance)
          << MotionPresetName(preset) << " " << n;
    }
  }
}

TEST(SimulateGyro, OffsetPutsTheSamplesOnTheirOwnClock) {
  const auto track = MakePresetOrientation(MotionPreset::kWalking, 1, kDurationS);
  ASSERT_TRUE(track);
  GyroSimulatorOptions options;
  const auto plain = SimulateGyro(*track, 0.0, 1.0, options);
  options.offset_s = 1.5;
  const auto shifted = SimulateGyro(*track, 0.0, 1.0, options);
  ASSERT_TRUE(plain && shifted);
  // t_video = t_gyro + offset
  EXPECT_NEAR(shifted->samples()[10].time_s, plain->samples()[10].time_s - 1.5, 1e-12);
  EXPECT_EQ(shifted->samples()[10].rate_rad_s, plain->samples()[10].rate_rad_s);
}

TEST(SimulateGyro, BiasAndNoiseAreWhatWasAskedFor) {
  const auto track = MakePresetOrientation(MotionPreset::kHandheld, 1, 10.0);
  ASSERT_TRUE(track);
  GyroSimulatorOptions options;
  const auto clean = SimulateGyro(*track, 0.0, 10.0, options);
  options.bias_rad_s = {0.01, -0.02, 0.03};
  options.noise_rad_s = 0.05;
  const auto noisy = SimulateGyro(*track, 0.0, 10.0, options);
  ASSERT_TRUE(clean && noisy);
  ASSERT_EQ(clean->samples().size(), 10001U);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double square = 0.0;
  for (std::size_t i = 0; i < clean->samples().size(); ++i) {
    const Eigen::Vector3d error = noisy->samples()[i].rate_rad_s - clean->samples()[i].rate_rad_s;
    sum += error;
    square += (error - options.bias_rad_s).squaredNorm();
  }
  const auto count = static_cast<double>(clean->samples().size());
  EXPECT_LT((sum / count - options.bias_rad_s).norm(), 0.003);  // 3 standard errors of 0.05 / 100
  EXPECT_NEAR(std::sqrt(square / count / 3.0), 0.05, 0.0015);
}

TEST(SimulateGyro, RefusesNonsense) {
  const auto track = MakePresetOrientation(MotionPreset::kHandheld, 1, 1.0);
  ASSERT_TRUE(track);
  EXPECT_FALSE(SimulateGyro(*track, 0.0, 1.0, {.sampling_hz = 0.0}));
  EXPECT_FALSE(SimulateGyro(*track, 0.0, 1.0, {.sampling_hz = 1000.0, .averaging_s = 0.01}));
  EXPECT_FALSE(SimulateGyro(*track, 0.0, 1.0, {.noise_rad_s = -1.0}));
  EXPECT_FALSE(SimulateGyro(*track, 1.0, 1.0));
  EXPECT_FALSE(SimulateGyro(*track, 0.0, 5.0));
}

}  // namespace
}  // namespace rsstab::igf
