// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/rs_motion_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "igf/base/rotation.h"
#include "igf/so3_spline.h"
#include "tests/stabilizer/shaky_camera.h"

namespace rsstab::stabilizer {
namespace {

using igf::MotionPreset;
using testing::kFocal;
using testing::kFrameS;
using testing::RegularTimes;
using testing::RootMeanSquare;
using testing::ShakyCamera;
using testing::UsualJerkWeight;

constexpr int kFrames = 30;
constexpr int kIterations = 8;
constexpr double kReadout = 0.02;

RsMotionWindow MakeWindow(const RsMotionModel& model, const std::vector<FramePairCells>& pairs,
                          RsMotionWindow::Freedom freedom = {}) {
  SplineStretch stretch;
  ExtendStretch(model, pairs, stretch);
  return {model, pairs, std::move(stretch), 1, freedom};
}

// RMS over frames of the largest error of a row; the ends, which lack a neighbour, left out.
double Error(const ShakyCamera& camera, const SplineStretch& stretch,
             const std::vector<double>& times_s) {
  igf::So3Spline spline(stretch.start_s, stretch.interval_s);
  for (const Eigen::Quaterniond& knot : stretch.knots) {
    spline.Append(knot);
  }
  std::vector<double> errors;
  for (std::size_t i = 2; i + 2 < times_s.size(); ++i) {
    errors.push_back(
        camera.RowError([&](double t) { return *spline.CameraFromWorld(t); }, times_s[i]));
  }
  return RootMeanSquare(errors);
}

struct Case {
  MotionPreset preset;
  double readout_s;
  double tolerance_px;
};

class KnownReadout : public ::testing::TestWithParam<Case> {};

// Tracks of 0.1 px averaged over 6 a cell and 48 cells a frame leave 0.02 px of noise a frame; what
// is left beyond is motion faster than two frames.
TEST_P(KnownReadout, MotionWithinFramesIsFound) {
  const auto [preset, readout_s, tolerance_px] = GetParam();
  const ShakyCamera camera(preset, readout_s);
  const auto times_s = RegularTimes(kFrames);
  RsMotionModel model = camera.Model();
  model.jerk_weight = UsualJerkWeight(preset);
  RsMotionWindow window = MakeWindow(model, camera.Pairs(times_s));
  ASSERT_TRUE(window.Solve(kIterations));
  std::vector<double> motion;
  for (const double t : times_s) {
    motion.push_back(camera.RowMotion(t));
  }
  EXPECT_LT(Error(camera, window.Stretch(), times_s), tolerance_px);
  EXPECT_GT(RootMeanSquare(motion), 5.0 * tolerance_px);
  EXPECT_LT(window.Parallax(), 0.3);
  // Taken to be read the other way round, the same tracks give another motion.
  model.readout_s = -readout_s;
  RsMotionWindow reversed = MakeWindow(model, camera.Pairs(times_s));
  ASSERT_TRUE(reversed.Solve(kIterations));
  EXPECT_GT(Error(camera, reversed.Stretch(), times_s), 3.0 * tolerance_px);
}

INSTANTIATE_TEST_SUITE_P(Motions, KnownReadout,
                         ::testing::Values(Case{MotionPreset::kHandheld, 0.02, 0.1},
                                           Case{MotionPreset::kWalking, 0.025, 0.15},
                                           Case{MotionPreset::kWalking, -0.025, 0.15},
                                           Case{MotionPreset::kVibration, 0.028, 0.87}));

TEST(RsMotionWindow, RefusesInSilenceAStartThatLooksAway) {
  const ShakyCamera camera(MotionPreset::kHandheld, kReadout);
  const auto pairs = camera.Pairs(RegularTimes(kFrames));
  const RsMotionModel model = camera.Model();
  SplineStretch stretch;
  ExtendStretch(model, pairs, stretch);
  for (std::size_t k = 0; k < stretch.knots.size(); ++k) {
    // From frame to frame by more than 90 degrees.
    stretch.knots[k] =
        ExpSo3(Eigen::Vector3d(0.0, 2.0 / kKnotsPerFrame * static_cast<double>(k), 0.0));
  }
  RsMotionWindow window(model, pairs, std::move(stretch), 1, {});
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(window.Solve(kIterations));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(RsMotionWindow, ReadoutAndFocalLengthAreFoundFromNearby) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  RsMotionModel model = camera.Model();
  model.jerk_weight = 0.1;
  model.readout_s = 0.7 * kReadout;
  model.focal = 0.9 * kFocal;
  RsMotionWindow window = MakeWindow(model, camera.Pairs(RegularTimes(40)), {true, true});
  ASSERT_TRUE(window.Solve(20));
  EXPECT_NEAR(window.readout_s(), kReadout, 0.05 * kReadout);
  EXPECT_NEAR(window.focal(), kFocal, 0.03 * kFocal);
}

// The covariance that the information promises is the one that repeated tracks of the same motion
// show.
TEST(RsMotionWindow, InformationIsTheScatterOfTheAnswer) {
  constexpr int kSeeds = 24;
  ShakyCamera camera(MotionPreset::kVibration, kReadout);
  camera.track_options.outlier_ratio = 0.0;
  camera.track_options.matches_per_pair = 130;  // cells stay below the limit of their weight
  RsMotionModel model = camera.Model();
  model.jerk_weight = 0.01;
  model.track_sigma_px = std::sqrt(2.0) * camera.track_options.noise_px;
  const auto times_s = RegularTimes(20);
  std::vector<double> readouts;
  double promised = 0.0;
  double mean = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    camera.track_options.seed = static_cast<unsigned>(seed);
    RsMotionWindow window = MakeWindow(model, camera.Pairs(times_s), {true, false});
    ASSERT_TRUE(window.Solve(kIterations));
    readouts.push_back(window.readout_s());
    mean += window.readout_s() / kSeeds;
    promised += std::sqrt(1.0 / window.ClipInformation()(0, 0)) / kSeeds;
  }
  double scatter = 0.0;
  for (const double readout : readouts) {
    scatter += (readout - mean) * (readout - mean) / (kSeeds - 1);
  }
  // 24 answers tell a deviation to 15%; the tracks of a cell do not all count alike, and lie
  // elsewhere each time.
  EXPECT_NEAR(std::sqrt(scatter) / promised, 1.0, 0.5);
}

std::size_t Largest(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

TEST(RsMotionWindow, EvidencePrefersTheTrueReadoutAndItsStiffness) {
  constexpr std::array<double, 6> kWeights = {0.003, 0.01, 0.03, 0.1, 0.3, 1.0};
  for (const auto& [preset, stiffest, softest] : {std::tuple(MotionPreset::kVibration, 2U, 0U),
                                                  std::tuple(MotionPreset::kHandheld, 5U, 3U)}) {
    const ShakyCamera camera(preset, kReadout);
    const auto pairs = camera.Pairs(RegularTimes(kFrames));
    std::vector<double> by_readout;
    for (const double share : {-1.0, 0.0, 0.5, 1.0, 1.5}) {
      RsMotionModel model = camera.Model();
      model.jerk_weight = 0.01;
      model.readout_s = share * kReadout;
      RsMotionWindow window = MakeWindow(model, pairs);
      ASSERT_TRUE(window.Solve(kIterations));
      const auto evidence = window.LogEvidence(kWeights);
      by_readout.push_back(*std::max_element(evidence.begin(), evidence.end()));
      if (share == 1.0) {
        EXPECT_LE(Largest(evidence), stiffest);
        EXPECT_GE(Largest(evidence), softest);
      }
    }
    EXPECT_EQ(Largest(by_readout), 3U);
    EXPECT_GT(by_readout[3], by_readout[1] + 10.0);  // against a global shutter: beyond doubt
  }
}

TEST(RsMotionWindow, FixedKnotsStay) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  const auto pairs = camera.Pairs(RegularTimes(12));
  SplineStretch start;
  ExtendStretch(camera.Model(), pairs, start);
  constexpr std::size_t kFixed = 9;
  RsMotionWindow window(camera.Model(), pairs, start, kFixed, {});
  ASSERT_TRUE(window.Solve(kIterations));
  const SplineStretch solved = window.Stretch();
  ASSERT_EQ(solved.knots.size(), start.knots.size());
  for (std::size_t k = 0; k < kFixed; ++k) {
    EXPECT_LT(solved.knots[k].angularDistance(start.knots[k]), 1e-9);
  }
  EXPECT_GT(solved.knots[kFixed + 5].angularDistance(start.knots[kFixed + 5]), 1e-6);
}

TEST(RsMotionWindow, PairsWithoutTracksLeaveTheStretchAsItIs) {
  const ShakyCamera camera(MotionPreset::kWalking, kReadout);
  FramePairCells pair;
  pair.to_time_s = kFrameS;
  SplineStretch start;
  ExtendStretch(camera.Model(), {&pair, 1}, start);
  RsMotionWindow window(camera.Model(), {&pair, 1}, start, 1, {true, true});
  EXPECT_TRUE(window.Solve(kIterations));
  EXPECT_EQ(window.Stretch().knots.size(), start.knots.size());
  EXPECT_TRUE(window.ClipInformation().isZero());
}

}  // namespace
}  // namespace rsstab::stabilizer
