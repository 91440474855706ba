// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_video_sync.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>

#include "igf/base/rotation.h"
#include "igf/gyro_simulator.h"
#include "igf/motion_presets.h"
#include "tests/igf/synthetic_tracks.h"

namespace rsstab::igf {
namespace {

using ::testing::HasSubstr;

// What users are promised.
constexpr double kOffsetTolerance_s = 2e-3;
constexpr double kReadoutTolerance = 0.05;
constexpr double kFocalTolerance = 0.02;
// What the estimator reaches on tracks with 0.15 px of noise and 20% outliers; ten times better, so
// that a regression shows long before the promise breaks.
constexpr double kReachedOffset_s = 0.4e-3;

constexpr double kDuration_s = 5.0;
constexpr double kFocal_px = 554.0;

// The prior that holds the bias against parallax pulls it a tenth of the way to zero.
constexpr double kBiasTolerance_rad_s = 5e-3;
const Eigen::Vector3d kBias(0.015, -0.02, 0.01);

Camera TrueCamera() { return Camera::Pinhole(640, 360, kFocal_px); }

GyroLog NoisyLog(const OrientationTrack& truth, double sampling_hz, double offset_s,
                 double begin_s = -0.3, double end_s = kDuration_s + 0.3) {
  GyroSimulatorOptions options;
  options.sampling_hz = sampling_hz;
  options.offset_s = offset_s;
  options.bias_rad_s = kBias;
  options.noise_rad_s = 0.005;
  return *SimulateGyro(truth, begin_s, end_s, options);
}

std::vector<PointTracks> Tracks(const OrientationTrack& truth, double readout_s) {
  testing::SyntheticTrackOptions options;
  options.readout_s = readout_s;
  return testing::MakeTracks(TrueCamera(), truth, kDuration_s, options);
}

struct MotionCase {
  MotionPreset preset;
  double sampling_hz;
  double offset_s;
};
void PrintTo(const MotionCase& c, std::ostream* out) {
  *out << MotionPresetName(c.preset) << " " << c.sampling_hz << " Hz";
}

class GyroVideoSync : public ::testing::TestWithParam<MotionCase> {};

TEST_P(GyroVideoSync, FindsTheOffset) {
  const MotionCase& c = GetParam();
  const OrientationTrack truth = *MakePresetOrientation(c.preset, 3, kDuration_s);
  Camera camera = TrueCamera();
  camera.readout_s = UsualReadout(c.preset);
  const auto sync = SynchronizeGyro(Tracks(truth, *camera.readout_s),
                                    NoisyLog(truth, c.sampling_hz, c.offset_s), camera);
  ASSERT_TRUE(sync) << sync.error().message;
  EXPECT_NEAR(sync->offset_s, c.offset_s, kReachedOffset_s);
  EXPECT_LT(sync->offset_sigma_s, kOffsetTolerance_s);
  EXPECT_LT((sync->bias_rad_s - kBias).norm(), kBiasTolerance_rad_s);
  EXPECT_GT(sync->confidence, 0.4);
  EXPECT_LT(sync->rms_px, 0.5 * sync->rms_without_gyro_px);
  EXPECT_EQ(sync->readout_s, *camera.readout_s);
  EXPECT_EQ(sync->focal_ratio, 1.0);
}

TEST_P(GyroVideoSync, FindsOffsetReadoutAndFocalLength) {
  const MotionCase& c = GetParam();
  const OrientationTrack truth = *MakePresetOrientation(c.preset, 3, kDuration_s);
  const double readout_s = UsualReadout(c.preset);
  const Camera guess = Camera::Pinhole(640, 360, 0.8 * 640);
  const auto sync =
      SynchronizeGyro(Tracks(truth, readout_s), NoisyLog(truth, c.sampling_hz, c.offset_s), guess,
                      {.focal_is_known = false, .lens_is_known = false});
  ASSERT_TRUE(sync) << sync.error().message;
  EXPECT_NEAR(sync->offset_s, c.offset_s, kReachedOffset_s);
  EXPECT_NEAR(sync->readout_s, readout_s, kReadoutTolerance * readout_s);
  EXPECT_NEAR(sync->camera.fx, kFocal_px, kFocalTolerance * kFocal_px);
  EXPECT_NEAR(sync->focal_ratio * guess.fx, sync->camera.fx, 1e-9);
  EXPECT_EQ(sync->camera.model, LensModel::kPinhole);
  EXPECT_EQ(sync->camera.readout_s, sync->readout_s);
  EXPECT_TRUE(sync->readout_is_trusted);
  EXPECT_TRUE(sync->focal_is_trusted);
}

INSTANTIATE_TEST_SUITE_P(Motions, GyroVideoSync,
                         ::testing::Values(MotionCase{MotionPreset::kHandheld, 200.0, -1.83},
                                           MotionCase{MotionPreset::kHandheld, 1000.0, 1.31},
                                           MotionCase{MotionPreset::kWalking, 400.0, 0.42},
                                           MotionCase{MotionPreset::kVibration, 200.0, 1.94},
                                           MotionCase{MotionPreset::kVibration, 1000.0, -0.77},
                                           MotionCase{MotionPreset::kFastPan, 400.0, -1.05}),
                         [](const auto& test) {
                           std::string name(MotionPresetName(test.param.preset));
                           std::erase(name, '-');
                           return name + std::to_string(static_cast<int>(test.param.sampling_hz)) +
                                  "Hz";
                         });

// Sign of the clock: a log that is shown 10 ms late on the video's clock has offset +10 ms.
TEST(GyroVideoSyncSigns, ALogTenMillisecondsEarlyHasAPositiveOffset) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kWalking, 1, kDuration_s);
  Camera camera = TrueCamera();
  camera.readout_s = 0.02;
  std::vector<GyroSample> samples;
  const GyroLog on_time = NoisyLog(truth, 400.0, 0.0);
  for (GyroSample sample : on_time.samples()) {
    sample.time_s -= 0.010;
    samples.push_back(sample);
  }
  const auto sync = SynchronizeGyro(Tracks(truth, 0.02), *GyroLog::Create(samples), camera);
  ASSERT_TRUE(sync) << sync.error().message;
  EXPECT_NEAR(sync->offset_s, 0.010, kReachedOffset_s);
}

TEST(GyroVideoSyncSigns, BottomToTopReadoutIsNegative) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kWalking, 2, kDuration_s);
  const auto sync =
      SynchronizeGyro(Tracks(truth, -0.025), NoisyLog(truth, 400.0, 0.2), TrueCamera());
  ASSERT_TRUE(sync) << sync.error().message;
  EXPECT_NEAR(sync->readout_s, -0.025, kReadoutTolerance * 0.025);
  EXPECT_NEAR(sync->offset_s, 0.2, kReachedOffset_s);
}

TEST(GyroVideoSyncLens, RecognisesAFisheye) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kWalking, 4, kDuration_s);
  Camera lens = Camera::Pinhole(640, 360, 417.0);  // 88 degrees wide
  lens.model = LensModel::kFisheye;
  lens.distortion = {0.02, 0.0, 0.0, 0.0};
  testing::SyntheticTrackOptions options;
  options.readout_s = 0.015;
  const auto tracks = testing::MakeTracks(lens, truth, kDuration_s, options);
  const auto sync =
      SynchronizeGyro(tracks, NoisyLog(truth, 400.0, 0.3), Camera::Pinhole(640, 360, 0.8 * 640),
                      {.focal_is_known = false, .lens_is_known = false});
  ASSERT_TRUE(sync) << sync.error().message;
  EXPECT_NEAR(sync->offset_s, 0.3, kReachedOffset_s);
  EXPECT_NEAR(sync->readout_s, 0.015, kReadoutTolerance * 0.015);
  EXPECT_EQ(sync->camera.model, LensModel::kFisheye);
  ASSERT_TRUE(sync->camera.Validate());
  // The same pixels for the same rays, to 1% of the distance from the centre.
  for (double angle = 0.1; angle < 0.75; angle += 0.1) {
    const Eigen::Vector3d ray(std::sin(angle), 0.0, std::cos(angle));
    const double expected = lens.ProjectRay(ray)->x() - lens.cx;
    EXPECT_NEAR(sync->camera.ProjectRay(ray)->x() - lens.cx, expected, 0.01 * expected) << angle;
  }
}

// Flying forward over near ground: everything below the horizon drifts, all the time.
TEST(GyroVideoSyncScene, SteadyParallaxDoesNotPullTheOffset) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kHandheld, 8, kDuration_s);
  Camera camera = TrueCamera();
  camera.readout_s = 0.02;
  auto tracks = Tracks(truth, 0.02);
  for (PointTracks& pair : tracks) {
    for (PointMatch& match : pair.matches) {
      const float below = std::max(0.0F, match.from.y() / 359.0F - 0.3F);
      match.to += 4.0F * below * Eigen::Vector2f((match.from.x() - 319.5F) / 320.0F, below);
    }
  }
  const auto sync = SynchronizeGyro(tracks, NoisyLog(truth, 400.0, 0.6), camera);
  ASSERT_TRUE(sync) << sync.error().message;
  EXPECT_NEAR(sync->offset_s, 0.6, kReachedOffset_s);
  EXPECT_LT((sync->bias_rad_s - kBias).norm(), 0.02);
}

// A log that begins late and stops early, with a hole in it: the rest decides.
TEST(GyroVideoSyncLog, UsesTheOverlapOnly) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kHandheld, 5, kDuration_s);
  Camera camera = TrueCamera();
  camera.readout_s = 0.02;
  std::vector<GyroSample> samples;
  const GyroLog part = NoisyLog(truth, 400.0, -1.2, 1.0, 4.2);
  for (const GyroSample& sample : part.samples()) {
    if (std::abs(sample.time_s - 1.2 - 2.3) > 0.1) {  // video time 2.3 s
      samples.push_back(sample);
    }
  }
  const auto log = GyroLog::Create(std::move(samples));
  ASSERT_TRUE(log) << log.error().message;
  ASSERT_FALSE(log->gaps().empty());
  const auto sync = SynchronizeGyro(Tracks(truth, 0.02), *log, camera);
  ASSERT_TRUE(sync) << sync.error().message;
  EXPECT_NEAR(sync->offset_s, -1.2, kOffsetTolerance_s);
}

void ExpectRefusal(const Result<GyroSyncResult>& sync, const std::string& reason) {
  ASSERT_FALSE(sync) << "offset " << sync->offset_s << ", confidence " << sync->confidence;
  EXPECT_EQ(sync.error().code, ErrorCode::kUntrustworthy);
  EXPECT_THAT(sync.error().message, HasSubstr(reason));
}

TEST(GyroVideoSyncRefuses, AnotherClipsLog) {
  for (const MotionPreset preset :
       {MotionPreset::kHandheld, MotionPreset::kWalking, MotionPreset::kVibration}) {
    const OrientationTrack truth = *MakePresetOrientation(preset, 6, kDuration_s);
    const OrientationTrack other = *MakePresetOrientation(preset, 1006, kDuration_s);
    ExpectRefusal(SynchronizeGyro(Tracks(truth, 0.02), NoisyLog(other, 400.0, 0.0), TrueCamera()),
                  "");
  }
}

TEST(GyroVideoSyncRefuses, ACameraThatStandsStill) {
  const OrientationTrack still = *OrientationTrack::Create(
      {-1.0, 7.0}, {Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()});
  ExpectRefusal(SynchronizeGyro(Tracks(still, 0.02), NoisyLog(still, 400.0, 0.0), TrueCamera()),
                "moves too little");
}

// One pure tone fits again after every period.
TEST(GyroVideoSyncRefuses, AVibrationThatRepeatsItself) {
  std::vector<double> times;
  std::vector<Eigen::Quaterniond> world_from_camera;
  for (double t = -1.0; t < kDuration_s + 1.0; t += 0.5e-3) {
    times.push_back(t);
    world_from_camera.push_back(
        ExpSo3(Eigen::Vector3d(0.004 * std::sin(2.0 * std::numbers::pi * 20.0 * t), 0.0, 0.0)));
  }
  const OrientationTrack truth =
      *OrientationTrack::Create(std::move(times), std::move(world_from_camera));
  Camera camera = TrueCamera();
  camera.readout_s = 0.02;
  const auto tracks = Tracks(truth, 0.02);
  const GyroLog log = NoisyLog(truth, 1000.0, 0.013);
  ExpectRefusal(SynchronizeGyro(tracks, log, camera), "several offsets");
  // Told where to look, it is sure.
  const auto narrow =
      SynchronizeGyro(tracks, log, camera, {.initial_offset_s = 0.0, .search_s = 0.02});
  ASSERT_TRUE(narrow) << narrow.error().message;
  EXPECT_NEAR(narrow->offset_s, 0.013, kReachedOffset_s);
}

TEST(GyroVideoSyncRefuses, ALogOfAnotherTime) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kWalking, 1, kDuration_s);
  ExpectRefusal(SynchronizeGyro(Tracks(truth, 0.02), NoisyLog(truth, 400.0, 100.0), TrueCamera()),
                "does not overlap");
}

TEST(GyroVideoSyncRefuses, TooFewTracks) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kWalking, 1, kDuration_s);
  const GyroLog log = NoisyLog(truth, 400.0, 0.0);
  ExpectRefusal(SynchronizeGyro({}, log, TrueCamera()), "0 of 0 frame pairs");
  auto tracks = Tracks(truth, 0.02);
  for (PointTracks& pair : tracks) {
    pair.matches.resize(3);
  }
  ExpectRefusal(SynchronizeGyro(tracks, log, TrueCamera()), "enough tracks");
}

TEST(GyroVideoSyncRefuses, OptionsThatMakeNoSense) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kWalking, 1, kDuration_s);
  const GyroLog log = NoisyLog(truth, 400.0, 0.0);
  const auto tracks = Tracks(truth, 0.02);
  const auto code = [&](const Camera& camera, const GyroSyncOptions& options) {
    return SynchronizeGyro(tracks, log, camera, options).error().code;
  };
  EXPECT_EQ(code(TrueCamera(), {.search_s = -1.0}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(TrueCamera(), {.search_s = 1e6}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(TrueCamera(), {.initial_offset_s = std::nan("")}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(Camera::Pinhole(0, 0, 1.0), {}), ErrorCode::kInvalidArgument);
  Camera fisheye = TrueCamera();
  fisheye.model = LensModel::kFisheye;
  fisheye.distortion = {0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(code(fisheye, {.focal_is_known = false}), ErrorCode::kInvalidArgument);
}

TEST(GyroVideoSyncDeterminism, SameInputSameBytes) {
  const OrientationTrack truth = *MakePresetOrientation(MotionPreset::kWalking, 1, kDuration_s);
  const GyroLog log = NoisyLog(truth, 400.0, 0.1);
  const auto tracks = Tracks(truth, 0.02);
  const auto first = SynchronizeGyro(tracks, log, TrueCamera());
  const auto second = SynchronizeGyro(tracks, log, TrueCamera());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->offset_s, second->offset_s);
  EXPECT_EQ(first->readout_s, second->readout_s);
}

}  // namespace
}  // namespace rsstab::igf
