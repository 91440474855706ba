// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

GyroLog Sampled(double sampling_hz, double seconds,
                const std::function<Eigen::Vector3d(double)>& rate) {
  std::vector<GyroSample> samples;
  const int count = static_cast<int>(std::lround(seconds * sampling_hz)) + 1;
  for (int i = 0; i < count; ++i) {
    const double t = i / sampling_hz;
    samples.push_back({t, rate(t)});
  }
  return *GyroLog::Create(std::move(samples));
}

TEST(GyroIntegrator, ConstantRateIsExact) {
  const Eigen::Vector3d rate(0.4, -1.1, 0.7);
  const OrientationTrack track = *IntegrateGyro(Sampled(200.0, 2.0, [&](double) { return rate; }));
  for (double t = 0.0; t < 2.0; t += 0.0371) {
    EXPECT_LT(track.CameraFromWorld(t)->angularDistance(ExpSo3(Eigen::Vector3d(-rate * t))), 1e-7);
  }
}

// Body rates multiply from the right: yaw by 90 degrees, then pitch about the camera's own (turned)
// x axis. World rates would give another direction.
TEST(GyroIntegrator, RatesAreInCameraAxes) {
  const double kQuarter = std::numbers::pi / 2.0;
  const OrientationTrack track = *IntegrateGyro(Sampled(1000.0, 2.0, [kQuarter](double t) {
    return t < 1.0 ? Eigen::Vector3d(0.0, kQuarter, 0.0) : Eigen::Vector3d(kQuarter, 0.0, 0.0);
  }));
  // After the yaw to the right the camera looks along world +x; a positive pitch (about x right,
  // with y down) then looks up, along world -y.
  const Eigen::Vector3d forward_in_world =
      track.CameraFromWorld(1.9995)->conjugate() * Eigen::Vector3d::UnitZ();
  constexpr double kStepAtTheCorner = 2e-3;  // the rate jumps within one sample interval
  EXPECT_LT((forward_in_world - Eigen::Vector3d(0.0, -1.0, 0.0)).norm(), kStepAtTheCorner);
}

TEST(GyroIntegrator, TakesTheBiasOff) {
  const Eigen::Vector3d rate(0.0, 0.3, 0.0);
  const Eigen::Vector3d bias(0.02, -0.01, 0.03);
  const OrientationTrack track =
      *IntegrateGyro(Sampled(200.0, 1.0, [&](double) -> Eigen::Vector3d { return rate + bias; }),
                     {.bias_rad_s = bias});
  EXPECT_LT(track.CameraFromWorld(0.9)->angularDistance(ExpSo3(Eigen::Vector3d(-rate * 0.9))),
            1e-7);
}

// A vibration about one axis has its integral in closed form, also between the samples.
TEST(GyroIntegrator, KeepsVibrationThatTheLogSamplesCoarsely) {
  struct Case {
    double sampling_hz;
    double vibration_hz;
    double max_relative_error;  // of the vibration's amplitude
  };
  for (const Case c : {Case{1000.0, 60.0, 0.01}, Case{400.0, 60.0, 0.01}, Case{200.0, 30.0, 0.01},
                       Case{200.0, 60.0, 0.08}}) {
    const double amplitude = 0.01;  // rad
    const double w = 2.0 * std::numbers::pi * c.vibration_hz;
    const OrientationTrack track = *IntegrateGyro(Sampled(c.sampling_hz, 1.0, [&](double t) {
      return Eigen::Vector3d(0.0, amplitude * w * std::cos(w * t), 0.0);
    }));
    const double start = LogSo3(*track.CameraFromWorld(0.3)).y() + amplitude * std::sin(w * 0.3);
    double worst = 0.0;
    for (double t = 0.3; t < 0.7; t += 0.00071) {
      const double yaw = -(LogSo3(*track.CameraFromWorld(t)).y() - start);
      worst = std::max(worst, std::abs(yaw - amplitude * std::sin(w * t)));
    }
    EXPECT_LT(worst, c.max_relative_error * amplitude)
        << c.vibration_hz << " Hz at " << c.sampling_hz << " Hz";
  }
}

TEST(GyroIntegrator, UnevenTimesFallBackToStraightLines) {
  std::vector<GyroSample> samples;
  double t = 0.0;
  for (int i = 0; i < 400; ++i) {
    samples.push_back({t, Eigen::Vector3d(0.0, t, 0.0)});  // linear: exact either way
    t += i % 3 == 0 ? 0.009 : 0.003;
  }
  const OrientationTrack track = *IntegrateGyro(*GyroLog::Create(std::move(samples)));
  EXPECT_NEAR(LogSo3(*track.CameraFromWorld(1.5)).y(), -0.5 * 1.5 * 1.5, 1e-7);
}

TEST(GyroIntegrator, GapsOfTheLogAreGapsOfTheTrack) {
  std::vector<GyroSample> samples;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.005 * i + (i >= 200 ? 0.2 : 0.0);
    samples.push_back({t, Eigen::Vector3d(0.0, 1.0, 0.0)});
  }
  const OrientationTrack track = *IntegrateGyro(*GyroLog::Create(std::move(samples)));
  EXPECT_TRUE(track.Covers(0.1, 0.99));
  EXPECT_TRUE(track.Covers(1.21, 2.1));
  EXPECT_FALSE(track.CameraFromWorld(1.1));
  EXPECT_FALSE(track.Covers(0.9, 1.3));
  EXPECT_NEAR(track.MeanRate(1.21, 2.1)->y(), 1.0, 1e-9);
}

// A propeller at 160 Hz goes, a hand's tremor and a 50 Hz vibration stay, on time.
TEST(GyroIntegrator, LowPassTakesOutWhatNoPictureShows) {
  constexpr double kAmplitude = 0.01;  // rad
  const auto swing = [](double frequency_hz, double low_pass_hz) {
    const double w = 2.0 * std::numbers::pi * frequency_hz;
    const OrientationTrack track = *IntegrateGyro(
        Sampled(
            400.0, 1.0,
            [&](double t) { return Eigen::Vector3d(0.0, kAmplitude * w * std::cos(w * t), 0.0); }),
        {.low_pass_hz = low_pass_hz});
    // Quarter-period instants, so that a delay would show as a smaller swing.
    const double top = (std::round(0.5 * frequency_hz) + 0.25) / frequency_hz;
    const double bottom = top + 0.5 / frequency_hz;
    return LogSo3(*track.CameraFromWorld(bottom)).y() - LogSo3(*track.CameraFromWorld(top)).y();
  };
  EXPECT_NEAR(swing(8.0, 100.0), 2.0 * kAmplitude, 0.02 * kAmplitude);
  EXPECT_NEAR(swing(50.0, 100.0), swing(50.0, 0.0), 0.1 * kAmplitude);
  EXPECT_NEAR(swing(160.0, 100.0), 0.0, 0.2 * kAmplitude);
}

TEST(GyroIntegrator, RefusesBadOptions) {
  const GyroLog log = Sampled(200.0, 1.0, [](double) { return Eigen::Vector3d::Zero().eval(); });
  EXPECT_FALSE(IntegrateGyro(log, {.max_step_s = 0.0}));
  EXPECT_FALSE(IntegrateGyro(log, {.low_pass_hz = -1.0}));
  GyroIntegrationOptions options;
  options.bias_rad_s.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(IntegrateGyro(log, options));
}

}  // namespace
}  // namespace rsstab::igf
