// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/clip_calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "igf/base/rotation.h"
#include "igf/orientation_track.h"
#include "tests/stabilizer/shaky_camera.h"

namespace rsstab::stabilizer {
namespace {

using igf::MotionPreset;
using testing::kFocal;
using testing::kFrameS;
using testing::kHeight;
using testing::kWidth;
using testing::RegularTimes;
using testing::ShakyCamera;

constexpr int kFrames = 90;
constexpr double kSigmas = 3.0;

using Change = std::function<void(PointTracks&)>;

ClipCalibration Calibrate(const ShakyCamera& camera, const Change& change = {},
                          ClipCalibrationOptions options = {}) {
  options.frame_interval_s = kFrameS;
  options.num_threads = 2;
  ClipCalibrator calibrator(options);
  for (PointTracks& tracks : camera.Tracks(RegularTimes(kFrames))) {
    if (change) {
      change(tracks);
    }
    calibrator.Push(SummarizeTracks(tracks, nullptr));
  }
  return calibrator.Calibrate();
}

void ExpectReadout(const ClipCalibration& found, double readout_s) {
  EXPECT_EQ(found.verdict, ShutterVerdict::kRolling);
  EXPECT_TRUE(found.readout_s.trusted);
  EXPECT_NEAR(found.readout_s.value, readout_s, 0.1 * std::abs(readout_s));
  EXPECT_LT(std::abs(found.readout_s.value - readout_s), kSigmas * found.readout_s.sigma);
  EXPECT_LT(found.readout_s.sigma, 0.1 * kFrameS);
}

void ExpectNothingToCorrect(const ClipCalibration& found) {
  EXPECT_TRUE(found.verdict == ShutterVerdict::kGlobal ||
              found.verdict == ShutterVerdict::kCannotBeTold);
  EXPECT_EQ(found.readout_s.value, 0.0);
}

void ExpectHonestFocalLength(const ClipCalibration& found) {
  if (found.focal.trusted) {
    EXPECT_NEAR(found.focal.value, kFocal, 0.05 * kFocal);
    EXPECT_LT(std::abs(found.focal.value - kFocal), kSigmas * found.focal.sigma);
  }
}

class Readout : public ::testing::TestWithParam<double> {};

// Readout and focal length, unknown both. Three seconds tell the latter to 2 or 3%, one sigma.
TEST_P(Readout, IsFoundFromAWalk) {
  const ClipCalibration found = Calibrate(ShakyCamera(MotionPreset::kWalking, GetParam()));
  ExpectReadout(found, GetParam());
  ExpectHonestFocalLength(found);
  // The curve goes over negative and positive readouts and is highest by the true one, as near as
  // its steps allow.
  ASSERT_FALSE(found.curve.empty());
  EXPECT_LT(found.curve.front().readout_s, 0.0);
  EXPECT_GT(found.curve.back().readout_s, 0.0);
  const auto highest = std::max_element(
      found.curve.begin(), found.curve.end(),
      [](const auto& a, const auto& b) { return a.log_evidence < b.log_evidence; });
  const double step_s = found.curve[1].readout_s - found.curve[0].readout_s;
  EXPECT_LT(std::abs(highest->readout_s - GetParam()), step_s);
}

INSTANTIATE_TEST_SUITE_P(Walk, Readout, ::testing::Values(0.01, 0.02, 0.03, -0.02));

// Other noise each time: answers lie where their standard deviations say.
TEST(ClipCalibrator, StandardDeviationsAreHonest) {
  for (const auto& [preset, seed] :
       {std::pair(MotionPreset::kHandheld, 1U), std::pair(MotionPreset::kHandheld, 2U),
        std::pair(MotionPreset::kFastPan, 1U)}) {
    const double readout_s = igf::UsualReadout(preset);
    const ClipCalibration found = Calibrate(ShakyCamera(preset, readout_s, 4.0, seed));
    ExpectReadout(found, readout_s);
    ExpectHonestFocalLength(found);
    EXPECT_GT(found.jerk_weight, 0.05);
    EXPECT_FALSE(found.vibrates);
  }
}

// Fast vibration looks alike at several readout times: one is taken for this clip, none for the
// camera.
TEST(ClipCalibrator, VibrationIsNotTrustedWithTheCamerasReadout) {
  unsigned seed = 1;
  for (const double readout_s : {0.01, 0.02, 0.028}) {
    const ClipCalibration found =
        Calibrate(ShakyCamera(MotionPreset::kVibration, readout_s, 4.0, seed++));
    EXPECT_EQ(found.verdict, ShutterVerdict::kRolling);
    EXPECT_TRUE(found.vibrates);
    EXPECT_FALSE(found.readout_s.trusted);
    EXPECT_GT(found.readout_s.value, 0.0);
    EXPECT_LT(std::abs(found.readout_s.value - readout_s), 2.0 * found.readout_s.sigma);
    ExpectHonestFocalLength(found);
  }
}

TEST(ClipCalibrator, GlobalShutterIsRecognised) {
  for (const MotionPreset preset : {MotionPreset::kWalking, MotionPreset::kVibration}) {
    const ClipCalibration found = Calibrate(ShakyCamera(preset, 0.0));
    EXPECT_EQ(found.verdict, ShutterVerdict::kGlobal);
    EXPECT_EQ(found.readout_s.value, 0.0);
    EXPECT_LT(found.readout_s.sigma, 0.1 * kFrameS);
  }
}

// A camera that turns at a steady rate about y.
ShakyCamera SteadyPan(double rate_rad_s, double readout_s) {
  ShakyCamera camera(MotionPreset::kHandheld, readout_s);
  camera.truth = igf::OrientationTrack::Create(
                     {-1.0, 5.0}, {ExpSo3(Eigen::Vector3d(0.0, -rate_rad_s, 0.0)),
                                   ExpSo3(Eigen::Vector3d(0.0, 5.0 * rate_rad_s, 0.0))})
                     .value();
  return camera;
}

TEST(ClipCalibrator, ACameraOnAStandAndASteadyPanTellNothing) {
  for (const double rate_rad_s : {0.0, 0.3}) {
    const ClipCalibration found = Calibrate(SteadyPan(rate_rad_s, 0.02));
    EXPECT_EQ(found.verdict, ShutterVerdict::kCannotBeTold) << rate_rad_s;
    EXPECT_EQ(found.readout_s.value, 0.0);
    EXPECT_FALSE(found.readout_s.trusted);
  }
}

TEST(ClipCalibrator, AForegroundObjectDoesNotMatter) {
  // A third of the picture goes its own, changing way.
  const Change object = [](PointTracks& tracks) {
    const double sway = 4.0 * std::sin(20.0 * tracks.from_time_s);
    for (PointMatch& m : tracks.matches) {
      if (m.from.x() > 0.35F * kWidth && m.from.x() < 0.68F * kWidth) {
        m.to += Eigen::Vector2f(3.0F, static_cast<float>(sway));
      }
    }
  };
  ExpectReadout(Calibrate(ShakyCamera(MotionPreset::kWalking, 0.02), object), 0.02);
}

TEST(ClipCalibrator, RepeatedAndMissingFramesDoNotMatter) {
  const ShakyCamera camera(MotionPreset::kWalking, 0.025);
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0F, 0.03F);  // repeats that were encoded again
  for (const bool repeats : {true, false}) {
    ClipCalibrationOptions options;
    options.frame_interval_s = kFrameS;
    ClipCalibrator calibrator(options);
    std::vector<double> content_s;
    std::vector<double> told_s;
    for (int i = 0; i < kFrames; ++i) {
      if (i % 7 == 6 && !repeats) {
        continue;
      }
      told_s.push_back(i * kFrameS);
      content_s.push_back((i % 7 == 6 ? i - 1 : i) * kFrameS);
    }
    auto all = camera.Tracks(content_s);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (content_s[i] == content_s[i + 1]) {
        for (PointMatch& m : all[i].matches) {
          m.to = m.from + Eigen::Vector2f(noise(random), noise(random));
        }
      }
      all[i].from_time_s = told_s[i];
      all[i].to_time_s = told_s[i + 1];
      calibrator.Push(SummarizeTracks(all[i], nullptr));
    }
    ExpectReadout(calibrator.Calibrate(), 0.025);
  }
}

// Steps shift the camera past a scene of which every point lies at its own depth.
Change Parallax(double shift_px) {
  return [shift_px](PointTracks& tracks) {
    const double shift = shift_px * std::sin(12.0 * tracks.from_time_s);
    for (PointMatch& m : tracks.matches) {
      const double near = 0.5 + 0.5 * std::sin(0.02 * m.from.x()) * std::cos(0.03 * m.from.y());
      m.to += Eigen::Vector2f(static_cast<float>(shift * near), 0.0F);
    }
  };
}

TEST(ClipCalibrator, ParallaxIsNoRollingShutter) {
  ExpectNothingToCorrect(Calibrate(ShakyCamera(MotionPreset::kWalking, 0.0), Parallax(1.5)));
}

TEST(ClipCalibrator, RollingShutterIsFoundBesideParallax) {
  const ClipCalibration found = Calibrate(ShakyCamera(MotionPreset::kWalking, 0.02), Parallax(1.0));
  EXPECT_EQ(found.verdict, ShutterVerdict::kRolling);
  EXPECT_NEAR(found.readout_s.value, 0.02, 0.15 * 0.02);
}

TEST(ClipCalibrator, GivenNumbersAreKept) {
  ClipCalibrationOptions options;
  options.readout_s = 0.015;
  options.focal = 0.7;
  const ClipCalibration found = Calibrate(ShakyCamera(MotionPreset::kWalking, 0.02), {}, options);
  EXPECT_EQ(found.verdict, ShutterVerdict::kGiven);
  EXPECT_EQ(found.readout_s.value, 0.015);
  EXPECT_EQ(found.focal.value, 0.7);
  EXPECT_TRUE(found.readout_s.trusted && found.focal.trusted);
  EXPECT_TRUE(found.curve.empty());
}

TEST(ClipCalibrator, NothingPushedIsNothingKnown) {
  const ClipCalibration found = ClipCalibrator({}).Calibrate();
  EXPECT_EQ(found.verdict, ShutterVerdict::kCannotBeTold);
  EXPECT_EQ(found.num_windows, 0U);
}

}  // namespace
}  // namespace rsstab::stabilizer
