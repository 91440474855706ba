// SPDX-License-Identifier: Apache-2.0
#include "igf/intra_gyro_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "igf/base/rolling_shutter.h"
#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

constexpr double kFrameTime = 1.0;
// The row table and the fixed point's stopping rule together; a hundredth of a pixel is a tenth of
// what resampling leaves.
constexpr double kFieldTolerance_px = 0.01;

// A camera that turns by `orientation(t)`, sampled at 2 kHz from 0 to 2 s.
template <typename Orientation>
OrientationTrack Track(const Orientation& orientation) {
  std::vector<double> times;
  std::vector<Eigen::Quaterniond> world_from_camera;
  for (int i = 0; i <= 4000; ++i) {
    times.push_back(i * 0.5e-3);
    world_from_camera.push_back(orientation(times.back()));
  }
  return *OrientationTrack::Create(std::move(times), std::move(world_from_camera));
}

OrientationTrack Shaking() {
  return Track([](double t) {
    const double w = 2.0 * std::numbers::pi;
    return ExpSo3(Eigen::Vector3d(0.01 * std::sin(w * 18.0 * t),
                                  0.5 * t + 0.004 * std::sin(w * 45.0 * t),
                                  0.02 * std::cos(w * 7.0 * t)));
  });
}

OrientationTrack YawRight() {
  return Track([](double t) { return ExpSo3(Eigen::Vector3d(0.0, 1.0 * t, 0.0)); });
}

Camera Hero7() {
  Camera camera = Camera::Pinhole(1000, 750, 438.0);
  camera.model = LensModel::kFisheye;
  camera.distortion = {0.067292, -0.052752, 0.121414, -0.077412};
  return camera;
}

// Distance between p and where the direction of GS pixel x stands at the instant p's row is
// exposed.
double FixedPointError(const Camera& camera, const OrientationTrack& track, double readout_s,
                       const Eigen::Vector2d& x, const Eigen::Vector2d& p) {
  const double row = std::clamp(p.y(), 0.0, camera.height - 1.0);
  const double t = RowExposureTime(kFrameTime, row, camera.height, readout_s);
  const Eigen::Quaterniond row_from_ref =
      *track.CameraFromWorld(t) * track.CameraFromWorld(kFrameTime)->conjugate();
  return (*camera.ProjectRay(row_from_ref * *camera.UnprojectPixel(x)) - p).norm();
}

TEST(IntraGyroField, SolvesTheFixedPointForEveryLensAndDirection) {
  Camera brown = Camera::Pinhole(1000, 750, 800.0);
  brown.model = LensModel::kBrown;
  brown.distortion = {-0.2, 0.05, 0.001, -0.002, -0.005};
  const OrientationTrack track = Shaking();
  for (const Camera& camera : {Camera::Pinhole(1920, 1080, 1500.0), brown, Hero7()}) {
    for (const double readout_s : {0.028, -0.028}) {
      const auto field = ComputeIntraGyroField(camera, track, kFrameTime, readout_s);
      ASSERT_TRUE(field) << field.error().message;
      EXPECT_GT(field->MaxLength(), 5.0);
      for (int row = 0; row < field->rows(); ++row) {
        for (int column = 0; column < field->columns(); ++column) {
          const Eigen::Vector2d x = field->VertexPosition(column, row);
          const Eigen::Vector2d p = x + field->At(column, row).cast<double>();
          EXPECT_LT(FixedPointError(camera, track, readout_s, x, p), kFieldTolerance_px)
              << x.transpose();
        }
      }
    }
  }
}

// Yaw to the right moves the picture left; with the top row first, the top was exposed before the
// middle row (its content stands to the right of where it belongs) and the bottom after it.
TEST(IntraGyroField, YawToTheRightSlantsTheFrame) {
  const Camera camera = Camera::Pinhole(640, 361, 500.0);
  const MotionField down = *ComputeIntraGyroField(camera, YawRight(), kFrameTime, 0.020);
  const int middle = down.columns() / 2;
  EXPECT_NEAR(down.At(middle, 0).x(), 500.0 * 0.010, 0.05);
  EXPECT_NEAR(down.At(middle, down.rows() / 2).norm(), 0.0, 1e-3);
  EXPECT_NEAR(down.At(middle, down.rows() - 1).x(), -500.0 * 0.010, 0.05);
  EXPECT_EQ(down.reference_row(), 180.0);
  const MotionField up = *ComputeIntraGyroField(camera, YawRight(), kFrameTime, -0.020);
  EXPECT_NEAR(up.At(middle, 0).x(), -500.0 * 0.010, 0.05);
  EXPECT_NEAR(up.At(middle, up.rows() - 1).x(), 500.0 * 0.010, 0.05);
}

TEST(IntraGyroField, GlobalShutterNeedsNothing) {
  const MotionField field =
      *ComputeIntraGyroField(Camera::Pinhole(640, 360, 500.0), YawRight(), 100.0, 0.0);
  EXPECT_EQ(field.MaxLength(), 0.0);
}

TEST(IntraGyroField, RefusesAFrameThatTheTrackDoesNotCover) {
  const Camera camera = Camera::Pinhole(640, 360, 500.0);
  for (const double frame_time_s : {0.005, 1.995, 7.0}) {
    const auto field = ComputeIntraGyroField(camera, YawRight(), frame_time_s, 0.020);
    ASSERT_FALSE(field) << frame_time_s;
    EXPECT_EQ(field.error().code, ErrorCode::kUntrustworthy);
  }
  EXPECT_FALSE(ComputeIntraGyroField(camera, YawRight(), kFrameTime, 0.020, {1, 65}));
  EXPECT_FALSE(ComputeIntraGyroField(camera, YawRight(), std::nan(""), 0.020));
}

TEST(IntraGyroField, WorksOnTheSmallestImage) {
  const auto field =
      ComputeIntraGyroField(Camera::Pinhole(1, 1, 1.0), YawRight(), kFrameTime, 0.020);
  ASSERT_TRUE(field);
  EXPECT_LT(field->MaxLength(), 0.05);
}

TEST(ReadoutMotion, MapsAreInverse) {
  for (const Camera& camera : {Camera::Pinhole(1920, 1080, 1500.0), Hero7()}) {
    const ReadoutMotion motion =
        *ComputeReadoutMotion(camera, Shaking(), kFrameTime, 0.025, (camera.height - 1) / 2.0);
    for (double y = 40.0; y < camera.height - 40.0; y += 61.0) {
      for (double x = 40.0; x < camera.width - 40.0; x += 97.0) {
        const auto rs = motion.RsFromGs({x, y});
        ASSERT_TRUE(rs);
        const auto gs = motion.GsFromRs(*rs);
        ASSERT_TRUE(gs);
        EXPECT_LT((*gs - Eigen::Vector2d(x, y)).norm(), kFieldTolerance_px) << x << "," << y;
      }
    }
  }
}

TEST(ReadoutMotion, ReferenceRowStaysInPlace) {
  const Camera camera = Camera::Pinhole(640, 360, 500.0);
  const ReadoutMotion motion = *ComputeReadoutMotion(camera, Shaking(), kFrameTime, 0.025, 0.0);
  EXPECT_LT((*motion.GsFromRs({100.0, 0.0}) - Eigen::Vector2d(100.0, 0.0)).norm(), 1e-9);
  EXPECT_GT((*motion.GsFromRs({100.0, 359.0}) - Eigen::Vector2d(100.0, 359.0)).norm(), 1.0);
}

// The published form: each grid point by the homography of its own band, relative to the first.
TEST(BandField, MovesEachPointByItsOwnBand) {
  const Camera camera = Camera::Pinhole(800, 600, 700.0);
  const OrientationTrack track = Shaking();
  const double readout_s = 0.030;
  BandFieldOptions options;
  options.bands = 6;
  options.grid = {9, 31};
  const MotionField field = *ComputeBandField(camera, track, kFrameTime, readout_s, options);
  EXPECT_EQ(field.reference_row(), 49.5);
  const auto time_of = [&](int band) {
    return kFrameTime + readout_s * ((band + 0.5) / 6.0 - 0.5);
  };
  for (int row = 0; row < 31; ++row) {
    const Eigen::Vector2d x = field.VertexPosition(3, row);
    const int band = std::min(static_cast<int>((x.y() + 0.5) / 100.0), 5);
    const Eigen::Matrix3d h = RotationHomography(camera.K(), *track.CameraFromWorld(time_of(band)),
                                                 *track.CameraFromWorld(time_of(0)));
    const Eigen::Vector2d expected = (h * x.homogeneous()).hnormalized() - x;
    EXPECT_LT((field.At(3, row).cast<double>() - expected).norm(), 1e-4) << row;
  }
}

TEST(BandField, ManyBandsApproachTheFixedPointUpToItsFirstOrder) {
  const Camera camera = Camera::Pinhole(640, 361, 500.0);
  BandFieldOptions options;
  options.bands = 361;
  options.reference_band = 180;
  const MotionField one_step = *ComputeBandField(camera, YawRight(), kFrameTime, 0.020, options);
  const MotionField fixed_point = *ComputeIntraGyroField(camera, YawRight(), kFrameTime, 0.020);
  EXPECT_EQ(one_step.reference_row(), fixed_point.reference_row());
  // A yaw hardly changes rows, so one step is nearly enough here; the corners differ by
  // |G| times the field's change per row, 5 px * 0.01.
  for (std::size_t i = 0; i < one_step.vertices().size(); ++i) {
    EXPECT_LT((one_step.vertices()[i] - fixed_point.vertices()[i]).norm(), 0.08F);
  }
}

TEST(BandField, RefusesImpossibleBands) {
  const Camera camera = Camera::Pinhole(640, 360, 500.0);
  BandFieldOptions options;
  options.bands = 361;
  EXPECT_FALSE(ComputeBandField(camera, YawRight(), kFrameTime, 0.020, options));
  options.bands = 4;
  options.reference_band = 4;
  EXPECT_FALSE(ComputeBandField(camera, YawRight(), kFrameTime, 0.020, options));
  options.reference_band = 0;
  const auto outside = ComputeBandField(camera, YawRight(), 3.0, 0.020, options);
  ASSERT_FALSE(outside);
  EXPECT_EQ(outside.error().code, ErrorCode::kUntrustworthy);
}

}  // namespace
}  // namespace rsstab::igf
