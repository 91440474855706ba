// SPDX-License-Identifier: Apache-2.0
#include "evaluation/path_angle_score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "igf/base/rotation.h"
#include "igf/motion_presets.h"
#include "tests/support/test_paths.h"

namespace rsstab::evaluation {
namespace {

using rsstab::testing::TemporaryFolder;
using stabilizer::FrameOrientation;
using ::testing::HasSubstr;

constexpr int kFrames = 90;
constexpr double kIntervalS = 1.0 / 30.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;
// Arithmetic only.
constexpr double kExact = 1e-6;
// Square roots turn the rounding of a product of rotations (1e-16) into 1e-8 rad.
constexpr double kExactDeg = 1e-5;

igf::SimulationTruth Walk() {
  igf::SimulationTruth truth{
      Camera::Pinhole(320, 180, 300.0),
      0.0,
      0.0,
      {},
      igf::MakePresetOrientation(igf::MotionPreset::kWalking, 3, 4.0).value()};
  for (int n = 0; n < kFrames; ++n) {
    truth.frame_times_s.push_back(n * kIntervalS);
  }
  return truth;
}

using Change =
    std::function<Eigen::Quaterniond(const Eigen::Quaterniond& camera_from_world, int n)>;

OrientationPath Changed(OrientationPath path, const Change& change) {
  for (std::size_t n = 0; n < path.size(); ++n) {
    path[n]->camera_from_world = change(path[n]->camera_from_world, static_cast<int>(n));
  }
  return path;
}

PathAngleScore Score(const OrientationPath& found, const OrientationPath& reference) {
  const auto score = ScorePathAngle(found, reference, kIntervalS);
  EXPECT_TRUE(score) << score.error().message;
  return *score;
}

Eigen::Quaterniond Turn(double x, double y, double z) { return ExpSo3(Eigen::Vector3d(x, y, z)); }

TEST(PathAngleScore, TheWorldFrameIsFree) {
  const OrientationPath truth = TruePath(Walk());
  ASSERT_EQ(truth.size(), static_cast<std::size_t>(kFrames));
  const auto score =
      Score(Changed(truth, [](const auto& q, int) { return q * Turn(0.7, -2.0, 1.0); }), truth);
  EXPECT_EQ(score.known_share, 1.0);
  EXPECT_NEAR(*score.angle_deg, 0.0, kExactDeg);
  EXPECT_NEAR(*score.rate_deg_s, 0.0, kExactDeg);
  EXPECT_GT(*score.uncorrected_angle_deg, 0.5);  // the preset does shake
  EXPECT_GT(*score.uncorrected_rate_deg_s, 5.0);
}

// Wrong by the whole motion twice over, or turned the same way about an axis that is the other way.
TEST(PathAngleScore, AFlippedSignIsSeen) {
  const OrientationPath truth = TruePath(Walk());
  const auto inverse =
      Score(Changed(truth, [](const auto& q, int) { return q.conjugate(); }), truth);
  EXPECT_GT(*inverse.rate_deg_s, 1.5 * *inverse.uncorrected_rate_deg_s);
  EXPECT_GT(*inverse.angle_deg, 1.5 * *inverse.uncorrected_angle_deg);
  const auto mirrored = Score(
      Changed(truth,
              [](const auto& q, int) { return Eigen::Quaterniond(q.w(), q.x(), -q.y(), q.z()); }),
      truth);
  EXPECT_GT(*mirrored.rate_deg_s, 0.5 * *mirrored.uncorrected_rate_deg_s);
  // A constant turn of the camera against itself is no choice of the world: it swaps axes.
  const auto camera_turned = Score(
      Changed(truth, [](const auto& q, int) { return Turn(0, 0, 0.5) * q * Turn(0, 0, -0.5); }),
      truth);
  EXPECT_GT(*camera_turned.rate_deg_s, 0.1 * *camera_turned.uncorrected_rate_deg_s);
}

TEST(PathAngleScore, KnownErrorsComeOutAsTheyAre) {
  constexpr double kError = 0.002;  // rad
  const OrientationPath truth = TruePath(Walk());
  const auto jumpy = Score(
      Changed(truth,
              [](const auto& q, int n) { return Turn(n % 2 == 0 ? kError : -kError, 0, 0) * q; }),
      truth);
  // As many one way as the other, so that no constant turn takes any of it away.
  EXPECT_NEAR(*jumpy.angle_deg, kError * kDegrees, 1e-3 * kError * kDegrees);
  const double rate = 2.0 * kError * kDegrees / kIntervalS;
  EXPECT_NEAR(*jumpy.rate_deg_s, rate, 1e-3 * rate);
  EXPECT_NEAR(jumpy.rate_axes_deg_s->x(), rate, 1e-3 * rate);
  // As often there as back, but for the last step.
  EXPECT_LT(jumpy.drift_axes_deg_s->norm(), 1.1 * rate / (kFrames - 1));
  EXPECT_NEAR(jumpy.rate_axes_deg_s->z(), 0.0, 0.02 * rate);  // the walk rolls a little
}

TEST(PathAngleScore, DriftCountsInTheAngleAndHardlyInTheRate) {
  constexpr double kDriftDegS = 0.5;
  const OrientationPath truth = TruePath(Walk());
  const auto score = Score(
      Changed(truth, [](const auto& q,
                        int n) { return q * Turn(0, kDriftDegS / kDegrees * n * kIntervalS, 0); }),
      truth);
  EXPECT_NEAR(*score.rate_deg_s, kDriftDegS, 1e-3);
  EXPECT_NEAR(score.drift_axes_deg_s->norm(), kDriftDegS, 0.02 * kDriftDegS);  // the walk leans
  EXPECT_GT(score.drift_axes_deg_s->y(), 0.9 * kDriftDegS);
  // Evenly spread over its range.
  const double range = kDriftDegS * kFrames * kIntervalS;
  EXPECT_NEAR(*score.angle_deg, range / std::sqrt(12.0), 1e-2 * range);
}

TEST(PathAngleScore, NoRotationAtAllIsWrongByTheMotion) {
  constexpr double kRateDegS = 20.0;
  OrientationPath pan(kFrames);
  for (int n = 0; n < kFrames; ++n) {
    pan[static_cast<std::size_t>(n)] =
        FrameOrientation{Turn(0, -kRateDegS / kDegrees * n * kIntervalS, 0), 0};
  }
  const auto score = Score(OrientationPath(kFrames), pan);
  EXPECT_EQ(score.known_share, 0.0);
  EXPECT_FALSE(score.angle_deg);
  EXPECT_FALSE(score.rate_deg_s);
  EXPECT_FALSE(score.rate_axes_deg_s);
  EXPECT_NEAR(*score.uncorrected_rate_deg_s, kRateDegS, kExactDeg);
  const double range = kRateDegS * kFrames * kIntervalS;
  EXPECT_NEAR(*score.uncorrected_angle_deg, range / std::sqrt(12.0), 1e-2 * range);
}

TEST(PathAngleScore, WorldsAreAlignedEachForItself) {
  const OrientationPath truth = TruePath(Walk());
  OrientationPath found = truth;
  for (std::size_t n = kFrames / 2; n < found.size(); ++n) {
    found[n]->camera_from_world = found[n]->camera_from_world * Turn(1.0, 0.5, -0.5);
  }
  EXPECT_GT(*Score(found, truth).angle_deg, 10.0);  // one world would have to be one
  for (std::size_t n = kFrames / 2; n < found.size(); ++n) {
    found[n]->world = 1;
  }
  found[10].reset();
  const auto score = Score(found, truth);
  EXPECT_NEAR(score.known_share, 1.0 - 1.0 / kFrames, kExact);
  EXPECT_NEAR(*score.angle_deg, 0.0, kExactDeg);
  EXPECT_NEAR(*score.rate_deg_s, 0.0, kExactDeg);
}

TEST(PathAngleScore, PathsOfDifferentClipsAreRefused) {
  const OrientationPath truth = TruePath(Walk());
  const auto score = ScorePathAngle(OrientationPath(kFrames - 1), truth, kIntervalS);
  ASSERT_FALSE(score);
  EXPECT_THAT(score.error().message, HasSubstr("89 orientations is not compared with one of 90"));
  EXPECT_FALSE(ScorePathAngle(truth, truth, 0.0));
}

TEST(ReadOrientationPath, ReturnsWhatWasStored) {
  const TemporaryFolder folder;
  const std::string file = (folder / "analysis").string();
  auto writer = stabilizer::AnalysisWriter::Create(file).value();
  const OrientationPath truth = TruePath(Walk());
  for (int n = 0; n < 3; ++n) {
    stabilizer::FrameAnalysis frame;
    frame.pts = n;
    if (n != 1) {
      frame.orientation = truth[static_cast<std::size_t>(n)];
    }
    ASSERT_TRUE(writer->Append(frame));
  }
  stabilizer::ClipAnalysis clip;
  clip.width = 320;
  clip.height = 180;
  clip.frames_per_second = 30.0;
  ASSERT_TRUE(writer->Finish(clip));
  const auto path = ReadOrientationPath(file);
  ASSERT_TRUE(path);
  ASSERT_EQ(path->size(), 3U);
  EXPECT_FALSE((*path)[1]);
  EXPECT_LT((*path)[2]->camera_from_world.angularDistance(truth[2]->camera_from_world), kExact);
  EXPECT_FALSE(ReadOrientationPath("/nonexistent/analysis"));
}

}  // namespace
}  // namespace rsstab::evaluation
