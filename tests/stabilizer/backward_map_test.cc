// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/backward_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "igf/base/homography.h"
#include "igf/base/rotation.h"

namespace rsstab::stabilizer {
namespace {

constexpr int kWidth = 1920;
constexpr int kHeight = 1080;
constexpr double kFocal = 0.8 * kWidth;
// The promise of DefaultMapGrid.
constexpr double kMapTolerancePx = 0.02;
// A map stores float positions: half a unit in the last place near 2000.
constexpr double kFloatTolerancePx = 1e-4;

// 60 Hz during 30 ms of readout: 1.8 cycles down the frame.
Eigen::Vector2d Vibration(double y, int height) {
  const double phase = 2.0 * std::numbers::pi * 1.8 * (y / height - 0.5);
  const double amplitude = 15.0 * height / 1080.0;
  return {amplitude * std::sin(phase), 0.5 * amplitude * std::sin(phase + 0.7)};
}

MotionField VibrationField(int width, int height, int rows) {
  MotionField field(width, height, 2, rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < 2; ++c) {
      field.At(c, r) = Vibration(field.VertexPosition(c, r).y(), height).cast<float>();
    }
  }
  return field;
}

// Ten degrees about an axis that is none of the camera's, about the picture's centre, and a zoom.
Eigen::Matrix3d TiltedHomography(int width, int height) {
  const double focal = 0.8 * width;
  const Eigen::Matrix3d k = Camera::Pinhole(width, height, focal).K();
  const Eigen::Matrix3d zoomed = Camera::Pinhole(width, height, 1.2 * focal).K();
  const double angle = 10.0 * std::numbers::pi / 180.0;
  const Eigen::Quaterniond rotation =
      ExpSo3<double>(Eigen::Vector3d(0.5, 0.7, 0.5).normalized() * angle);
  return k * rotation.toRotationMatrix() * zoomed.inverse();
}

// Over the output pixels whose exact source is at least `margin_px` inside the picture.
template <typename Exact>
double LargestError(const BackwardMap& map, const Exact& exact, double margin_px = 0.0) {
  const Eigen::AlignedBox2d inside(
      Eigen::Vector2d::Constant(margin_px),
      Eigen::Vector2d(map.width() - 1, map.height() - 1) - Eigen::Vector2d::Constant(margin_px));
  double worst = 0.0;
  // Strides without common factor with the grid's spacing.
  for (int y = 0; y < map.height(); y += 3) {
    for (int x = 0; x < map.width(); x += 7) {
      const Eigen::Vector2d q(x, y);
      const Eigen::Vector2d source = exact(q);
      if (inside.contains(source)) {
        worst = std::max(worst, (map.Sample(q) - source).norm());
      }
    }
  }
  return worst;
}

TEST(BackwardMap, IsTheIdentityWhenMade) {
  const BackwardMap map(kWidth, kHeight, 13, 7);
  EXPECT_LT(LargestError(map, [](const Eigen::Vector2d& q) { return q; }), kFloatTolerancePx);
  EXPECT_EQ(map.At(12, 6), Eigen::Vector2f(kWidth - 1, kHeight - 1));
}

TEST(BackwardMap, ComposesTheIdentityFromAnEmptyWarp) {
  FrameWarp warp;
  warp.width = kWidth;
  warp.height = kHeight;
  const BackwardMap map = ComposeBackwardMap(warp);
  EXPECT_LT(LargestError(map, [](const Eigen::Vector2d& q) { return q; }), kFloatTolerancePx);
  EXPECT_LE(OverhangPx(map), 0.0);
}

TEST(BackwardMap, StaysWithinItsToleranceUnderVibrationAndTilt) {
  for (const auto& [width, height] :
       {std::pair{640, 360}, {1920, 1080}, {1080, 1920}, {3840, 2160}}) {
    FrameWarp warp;
    warp.width = width;
    warp.height = height;
    warp.rectified_from_output = TiltedHomography(width, height);
    // A vertex in every row: no interpolation error of its own.
    warp.rs_field = VibrationField(width, height, height);
    const BackwardMap map = ComposeBackwardMap(warp);
    // The motion stands still outside the recorded picture; cells that straddle its edge (with the
    // motion's amplitude and a row of vertices added) round that kink off.
    const double margin_px = (15.0 * height / 1080.0) + 16.0;
    const double error = LargestError(
        map,
        [&](const Eigen::Vector2d& q) -> Eigen::Vector2d {
          const Eigen::Vector3d r = warp.rectified_from_output * q.homogeneous();
          const Eigen::Vector2d p(r.x() / r.z(), r.y() / r.z());
          return p + Vibration(p.y(), height);
        },
        margin_px);
    EXPECT_LT(error, kMapTolerancePx) << width << "x" << height;
  }
}

TEST(BackwardMap, AppliesTheStepsInTheirOrder) {
  FrameWarp warp;
  warp.width = kWidth;
  warp.height = kHeight;
  warp.rectified_from_output << 0.9, 0.0, 30.0, 0.0, 0.9, 20.0, 0.0, 0.0, 1.0;
  warp.mesh_update = MotionField(kWidth, kHeight, 17, 17);
  for (int r = 0; r < 17; ++r) {
    for (int c = 0; c < 17; ++c) {
      warp.mesh_update.At(c, r) = Eigen::Vector2f(0.2F * static_cast<float>(r), 3.0F);
    }
  }
  Camera lens = Camera::Pinhole(kWidth, kHeight, kFocal);
  lens.model = LensModel::kBrown;
  lens.distortion = {-0.1, 0.02, 0.001, -0.002};
  warp.lens = lens;
  warp.rs_field = MotionField(kWidth, kHeight, 2, 3);
  warp.rs_field.At(0, 0) = warp.rs_field.At(1, 0) = Eigen::Vector2f(10.0F, -4.0F);
  warp.rs_field.At(0, 2) = warp.rs_field.At(1, 2) = Eigen::Vector2f(-10.0F, 4.0F);

  const auto exact = [&](const Eigen::Vector2d& q) -> Eigen::Vector2d {
    const Eigen::Vector2d rectified = 0.9 * q + Eigen::Vector2d(30.0, 20.0);
    const double mesh_row = rectified.y() * 16.0 / (kHeight - 1);
    const Eigen::Vector2d moved = rectified + Eigen::Vector2d(0.2 * mesh_row, 3.0);
    const double x = (moved.x() - lens.cx) / lens.fx;
    const double y = (moved.y() - lens.cy) / lens.fy;
    const double r2 = x * x + y * y;
    const double radial = 1.0 - 0.1 * r2 + 0.02 * r2 * r2;
    const double xd = x * radial + 2.0 * 0.001 * x * y - 0.002 * (r2 + 2.0 * x * x);
    const double yd = y * radial + 0.001 * (r2 + 2.0 * y * y) - 2.0 * 0.002 * x * y;
    const Eigen::Vector2d recorded(lens.fx * xd + lens.cx, lens.fy * yd + lens.cy);
    const double down = 1.0 - recorded.y() / ((kHeight - 1) / 2.0);  // 1 top, -1 bottom
    return recorded + down * Eigen::Vector2d(10.0, -4.0);
  };
  for (const Eigen::Vector2d& q :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(300.0, 900.0), Eigen::Vector2d(1500.5, 77.25)}) {
    const auto source = SourcePosition(warp, q);
    ASSERT_TRUE(source.has_value());
    EXPECT_LT((*source - exact(q)).norm(), 1e-5) << q.transpose();  // fields are float
  }
  EXPECT_LT(LargestError(ComposeBackwardMap(warp), exact), kMapTolerancePx);
}

TEST(BackwardMap, KeepsWhatDoesNotProjectFarOutside) {
  FrameWarp warp;
  warp.width = 64;
  warp.height = 48;
  warp.rectified_from_output << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0 / 32.0, 0.0, 1.0;
  EXPECT_FALSE(SourcePosition(warp, {40.0, 10.0}).has_value());
  const BackwardMap map = ComposeBackwardMap(warp);
  EXPECT_GT(OverhangPx(map), 1000.0);
  EXPECT_GT(UndefinedShare(map), 0.5);
}

TEST(BackwardMap, TellsHowFarTheWorstSourceLiesOutside) {
  BackwardMap map(100, 50, 3, 3);
  EXPECT_EQ(OverhangPx(map), 0.0);
  EXPECT_EQ(UndefinedShare(map), 0.0);
  map.At(2, 1).x() += 2.5F;
  EXPECT_DOUBLE_EQ(OverhangPx(map), 2.5);
  map.At(0, 0).y() -= 4.0F;
  EXPECT_DOUBLE_EQ(OverhangPx(map), 4.0);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      map.At(c, r) = Eigen::Vector2f(50.0F, 25.0F);
    }
  }
  EXPECT_DOUBLE_EQ(OverhangPx(map), -24.0);  // 24 px from the bottom row
  map.At(1, 1).x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(OverhangPx(map), std::numeric_limits<double>::infinity());
}

TEST(BackwardMap, CountsPixelsWithoutSource) {
  BackwardMap map(100, 50, 3, 3);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      map.At(c, r).x() += 9.75F;
    }
  }
  EXPECT_DOUBLE_EQ(UndefinedShare(map), 0.1);  // columns 90 to 99 of 100
}

TEST(BackwardMap, HoldsForPicturesOfOnePixel) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {17, 1}}) {
    FrameWarp warp;
    warp.width = width;
    warp.height = height;
    warp.rs_field = MotionField(width, height, 2, 2);
    const BackwardMap map = ComposeBackwardMap(warp);
    EXPECT_LE(OverhangPx(map), 0.0);
    EXPECT_EQ(map.Sample({0.0, 0.0}), Eigen::Vector2d(0.0, 0.0));
  }
}

}  // namespace
}  // namespace rsstab::stabilizer
