// SPDX-License-Identifier: Apache-2.0
#include "igf/motion_presets.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/homography.h"
#include "igf/base/rolling_shutter.h"
#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

constexpr double kFps = 30.0;
constexpr double kDurationS = 10.0;
constexpr int kFrames = 300;

// 640 px wide, 60 degrees: the view in which the presets' figures are stated.
Camera ReferenceCamera() {
  return Camera::Pinhole(640, 360, 320.0 / std::tan(std::numbers::pi / 6.0));
}

std::vector<Eigen::Vector2d> GridPoints(const Camera& camera, int columns, int rows) {
  std::vector<Eigen::Vector2d> points;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      points.emplace_back((c + 0.5) * camera.width / columns - 0.5,
                          (r + 0.5) * camera.height / rows - 0.5);
    }
  }
  return points;
}

// RMS second difference of the image motion on a 5x5 grid, px.
double Jitter(const OrientationTrack& track, const Camera& camera) {
  const std::vector<Eigen::Vector2d> points = GridPoints(camera, 5, 5);
  const auto motion = [&](int n, const Eigen::Vector2d& x) -> Eigen::Vector2d {
    const auto now = track.CameraFromWorld(n / kFps);
    const auto next = track.CameraFromWorld((n + 1) / kFps);
    return Project(RotationHomography(camera.K(), *next, *now), x) - x;
  };
  double sum = 0.0;
  int count = 0;
  for (int n = 0; n + 2 < kFrames; ++n) {
    for (const Eigen::Vector2d& x : points) {
      sum += (motion(n + 1, x) - motion(n, x)).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

// Where the direction that the global-shutter twin shows at x lies in the rolling-shutter frame.
Eigen::Vector2d SeenByRollingShutter(const OrientationTrack& track, const Camera& camera,
                                     double time_s, double readout_s, const Eigen::Vector2d& x) {
  Eigen::Vector2d p = x;
  for (int i = 0; i < 8; ++i) {
    const double row_time_s = RowExposureTime(time_s, p.y(), camera.height, readout_s);
    p = Project(RotationHomography(camera.K(), *track.CameraFromWorld(row_time_s),
                                   *track.CameraFromWorld(time_s)),
                x);
  }
  return p;
}

// RMS distance between rolling-shutter frames and their twins after the best rotation and zoom, px.
double CameraResidual(const OrientationTrack& track, const Camera& camera, double readout_s) {
  const std::vector<Eigen::Vector2d> points = GridPoints(camera, 8, 18);
  const Eigen::Matrix3d k = camera.K();
  double sum = 0.0;
  int count = 0;
  for (int n = 0; n < kFrames; n += 2) {
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector2d& x : points) {
      seen.push_back(SeenByRollingShutter(track, camera, n / kFps, readout_s, x));
    }
    const auto model = [&](const Eigen::Vector4d& a, const Eigen::Vector2d& x) -> Eigen::Vector2d {
      const Eigen::Matrix3d turned =
          k * ExpSo3(Eigen::Vector3d(a.head<3>())).toRotationMatrix() * k.inverse();
      const Eigen::Vector2d centre(camera.cx, camera.cy);
      return centre + (1.0 + a(3)) * (Project(turned, x) - centre);
    };
    Eigen::Vector4d a = Eigen::Vector4d::Zero();
    for (int iteration = 0; iteration < 4; ++iteration) {
      Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();
      Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
      for (std::size_t i = 0; i < points.size(); ++i) {
        constexpr double kStep = 1e-6;
        Eigen::Matrix<double, 2, 4> jacobian;
        for (int j = 0; j < 4; ++j) {
          const Eigen::Vector4d step = kStep * Eigen::Vector4d::Unit(j);
          jacobian.col(j) = (model(a + step, points[i]) - model(a - step, points[i])) / (2 * kStep);
        }
        hessian += jacobian.transpose() * jacobian;
        gradient += jacobian.transpose() * (seen[i] - model(a, points[i]));
      }
      a += hessian.ldlt().solve(gradient);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      sum += (seen[i] - model(a, points[i])).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

struct Figures {
  MotionPreset preset;
  double jitter_px;
  double residual_px;
};

class PresetFigures : public ::testing::TestWithParam<Figures> {};

// The header promises these figures; seeds differ in phases and frequencies only, which moves an
// RMS over ten seconds by this much.
TEST_P(PresetFigures, AreAsStrongAsTheHeaderSays) {
  constexpr double kSpread = 0.1;
  const Camera camera = ReferenceCamera();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto track = MakePresetOrientation(GetParam().preset, seed, kDurationS);
    ASSERT_TRUE(track) << track.error().message;
    const double jitter = Jitter(*track, camera);
    const double residual = CameraResidual(*track, camera, UsualReadout(GetParam().preset));
    const std::string name = "seed" + std::to_string(seed);
    RecordProperty(name + "_jitter_px", std::to_string(jitter));
    RecordProperty(name + "_residual_px", std::to_string(residual));
    EXPECT_NEAR(jitter, GetParam().jitter_px, kSpread * GetParam().jitter_px) << "seed " << seed;
    EXPECT_NEAR(residual, GetParam().residual_px, kSpread * GetParam().residual_px)
        << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(All, PresetFigures,
                         ::testing::Values(Figures{MotionPreset::kHandheld, 2.5, 0.51},
                                           Figures{MotionPreset::kWalking, 4.84, 1.18},
                                           Figures{MotionPreset::kVibration, 6.7, 1.88},
                                           Figures{MotionPreset::kFastPan, 2.28, 2.24}));

TEST(MotionPresets, EveryPresetHasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (const MotionPreset preset : kMotionPresets) {
    names.insert(MotionPresetName(preset));
  }
  EXPECT_EQ(names, (std::set<std::string_view>{"handheld", "walking", "vibration", "fast-pan"}));
}

TEST(MotionPresets, SameSeedSameMotionOtherSeedAnother) {
  for (const MotionPreset preset : kMotionPresets) {
    const PresetMotion a(preset, 7, kDurationS);
    const PresetMotion b(preset, 7, kDurationS);
    const PresetMotion c(preset, 8, kDurationS);
    EXPECT_EQ(a.Angles(1.234), b.Angles(1.234));
    EXPECT_NE(a.Angles(1.234), c.Angles(1.234));
  }
}

// Without hand shake the two pans cancel: the camera comes back.
TEST(MotionPresets, WhipPansTurnRightAndComeBack) {
  const PresetMotion motion(MotionPreset::kFastPan, 1, kDurationS);
  constexpr double kSway = 0.07;  // rad, several times the preset's hand shake
  EXPECT_NEAR(motion.Angles(0.5).y(), 0.0, kSway);
  EXPECT_NEAR(motion.Angles(4.5).y(), 55.0 * std::numbers::pi / 180.0, kSway);
  EXPECT_NEAR(motion.Angles(9.5).y(), 0.0, kSway);
}

TEST(MotionPresets, SampledTrackIsTheSmoothMotion) {
  // h^2 / 8 times the angular acceleration: 0.25 ms steps, 60 Hz at 4 mrad.
  constexpr double kSlerpError = 5e-6;
  for (const MotionPreset preset : kMotionPresets) {
    const PresetMotion motion(preset, 5, 2.0);
    const auto track = MakePresetOrientation(preset, 5, 2.0);
    ASSERT_TRUE(track) << track.error().message;
    EXPECT_TRUE(track->Covers(-kPresetMarginS, 2.0 + kPresetMarginS - 1e-9));
    for (double t = -0.4; t < 2.4; t += 0.00737) {
      const auto camera_from_world = track->CameraFromWorld(t);
      ASSERT_TRUE(camera_from_world);
      EXPECT_LT(LogSo3(Eigen::Quaterniond(*camera_from_world * motion.WorldFromCamera(t))).norm(),
                kSlerpError)
          << t;
    }
  }
}

TEST(MotionPresets, RefusesADurationThatIsNone) {
  EXPECT_FALSE(MakePresetOrientation(MotionPreset::kHandheld, 1, 0.0));
  EXPECT_FALSE(MakePresetOrientation(MotionPreset::kHandheld, 1, std::nan("")));
}

}  // namespace
}  // namespace rsstab::igf
