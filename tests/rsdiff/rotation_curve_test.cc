// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/rotation_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "igf/base/rotation.h"
#include "igf/intra_gyro_field.h"
#include "igf/orientation_track.h"

namespace rsstab::rsdiff {
namespace {

constexpr double kExact = 1e-12;
// Both fields come from the same 257 row rotations; fixed point and float32 leave this.
constexpr double kSameTruth_px = 1e-3;

// Values that grow evenly from the first band to the last, `step` per band, zero in the middle.
RotationCurve Steady(int bands, const Eigen::Vector3d& step) {
  RotationCurve curve;
  for (int b = 0; b < bands; ++b) {
    curve.push_back((b - (bands - 1) / 2.0) * step);
  }
  return curve;
}

RotationCurve Shaking(int bands) {
  RotationCurve curve;
  for (int b = 0; b < bands; ++b) {
    const double s = (b + 0.5) / bands - 0.5;
    curve.emplace_back(0.03 * std::sin(9.0 * s), 0.02 * std::cos(7.0 * s), 0.05 * s * s - 0.03 * s);
  }
  return curve;
}

TEST(CurveAtRow, PassesThroughTheBandCentres) {
  const RotationCurve curve = Shaking(12);
  for (int b = 0; b < 12; ++b) {
    const double row = (b + 0.5) / 12.0 * 600.0 - 0.5;
    EXPECT_LT((CurveAtRow(curve, row, 600) - curve[static_cast<std::size_t>(b)]).norm(), kExact);
  }
}

TEST(CurveAtRow, AStraightLineStaysStraightToTheEdges) {
  const Eigen::Vector3d step(0.01, -0.02, 0.005);
  const RotationCurve curve = Steady(8, step);
  for (const double row : {-0.5, 0.0, 13.2, 99.0, 250.7, 399.0, 399.5}) {
    const double position = (row + 0.5) / 400.0 * 8.0 - 0.5;
    EXPECT_LT((CurveAtRow(curve, row, 400) - (position - 3.5) * step).norm(), kExact) << row;
  }
}

// Catmull-Rom half-way between two centres: 9/16 of the two, -1/16 of their neighbours; at the ends
// the tangent is the one-sided difference.
TEST(CurveAtRow, IsCatmullRomBetweenCentres) {
  const auto value = [](double v) { return Eigen::Vector3d(v, -v, 2.0 * v); };
  const RotationCurve curve = {value(1.0), value(4.0), value(2.0), value(7.0)};
  const int height = 400;
  const auto at = [&](double position) {
    return CurveAtRow(curve, (position + 0.5) / 4.0 * height - 0.5, height).x();
  };
  EXPECT_NEAR(at(1.5), (9.0 * (4.0 + 2.0) - 1.0 - 7.0) / 16.0, kExact);
  // Hermite: (p0 + p1) / 2 + (m0 - m1) / 8.
  EXPECT_NEAR(at(0.5), (1.0 + 4.0) / 2.0 + (3.0 - 0.5) / 8.0, kExact);
  EXPECT_NEAR(at(-0.5), 1.0 - 0.5 * 3.0, kExact);
  EXPECT_NEAR(at(3.5), 7.0 + 0.5 * 5.0, kExact);
}

TEST(CurveAtRow, OneBandIsConstant) {
  const RotationCurve curve = {Eigen::Vector3d(1.0, 2.0, 3.0)};
  EXPECT_EQ(CurveAtRow(curve, 0.0, 10), curve.front());
  EXPECT_EQ(CurveAtRow(curve, 9.0, 10), curve.front());
}

// a moves the image centre's G to the right, b down, by image heights; r turns clockwise.
TEST(FieldFromCurve, HasTheStatedSignsAndUnits) {
  const Camera camera = Camera::Pinhole(801, 601, 700.0);
  const int bands = 10;
  const double rows_per_band = 601.0 / bands;
  // The bottom row lies 300 rows below the middle one, so 300 / rows_per_band bands.
  const double bands_below = 300.0 / rows_per_band;
  const double step = 0.003;
  const auto at_bottom = [&](const Eigen::Vector3d& direction, int column) {
    const MotionField field = *FieldFromCurve(Steady(bands, step * direction), camera, {17, 65});
    return field.At(column, 64).cast<double>().eval();
  };
  const double shift_px = step * bands_below * 601.0;
  const double angle = step * bands_below;
  // Perspective adds the square of the angle off the axis: yaw moves x by f (tan(u + w) - tan u).
  const Eigen::Vector2d yaw = at_bottom(Eigen::Vector3d::UnitX(), 8);
  const double yaw_rad = shift_px / 700.0;
  EXPECT_NEAR(yaw.x(), 700.0 * std::tan(yaw_rad), 0.2);
  EXPECT_GT(yaw.x(), 8.0);
  const Eigen::Vector2d pitch = at_bottom(Eigen::Vector3d::UnitY(), 8);
  EXPECT_GT(pitch.y(), 8.0);
  // Roll: (x, y) -> (x - r y, y + r x) to first order; the rows that it brings in turn it further.
  const Eigen::Vector2d left = at_bottom(Eigen::Vector3d::UnitZ(), 0);
  EXPECT_NEAR(left.x(), -angle * 300.0, 0.2);
  EXPECT_LT(left.y(), -0.9 * angle * 400.0);
  const Eigen::Vector2d right = at_bottom(Eigen::Vector3d::UnitZ(), 16);
  EXPECT_GT(right.y(), 0.9 * angle * 400.0);
}

TEST(FieldFromCurve, IsZeroOnTheMiddleRowWhateverTheCurve) {
  RotationCurve curve = Shaking(24);
  for (Eigen::Vector3d& value : curve) {
    value += Eigen::Vector3d(0.01, 0.02, 0.03);
  }
  const MotionField field = *FieldFromCurve(curve, Camera::Pinhole(640, 361, 500.0), {9, 61});
  EXPECT_EQ(field.reference_row(), 180.0);
  for (int column = 0; column < 9; ++column) {
    EXPECT_LT(field.At(column, 30).norm(), 1e-3F);
  }
  EXPECT_GT(field.MaxLength(), 5.0);
}

// The same readout told as a curve and as an orientation track.
TEST(FieldFromCurve, AgreesWithTheGyroFieldOfTheSameTruth) {
  constexpr double kFrameTime_s = 1.0;
  for (const auto& [width, height, focal_px] :
       {std::tuple{1920, 1080, 1500.0}, std::tuple{480, 640, 400.0}, std::tuple{800, 600, 800.0}}) {
    const Camera camera = Camera::Pinhole(width, height, focal_px);
    const RotationCurve curve = Shaking(24);
    for (const double readout_s : {0.024, -0.024}) {
      // Upwards readout: time runs from the last row to the first.
      const int knots = ReadoutMotion::KnotCount(height);
      const auto rotations = RowRotationsFromCurve(curve, camera, knots);
      std::vector<double> times;
      std::vector<Eigen::Quaterniond> world_from_camera;
      for (int i = 0; i < knots; ++i) {
        const int k = readout_s > 0.0 ? i : knots - 1 - i;
        const double row = (height - 1.0) * k / (knots - 1);
        times.push_back(kFrameTime_s + readout_s * ((row + 0.5) / height - 0.5));
        world_from_camera.push_back(rotations[static_cast<std::size_t>(k)].conjugate());
      }
      times.front() -= 1e-9;  // the track's span is half-open
      times.back() += 1e-9;
      const auto track = igf::OrientationTrack::Create(times, world_from_camera);
      ASSERT_TRUE(track) << track.error().message;
      const auto expected =
          igf::ComputeIntraGyroField(camera, *track, kFrameTime_s, readout_s, {17, 65});
      ASSERT_TRUE(expected) << expected.error().message;
      const MotionField field = *FieldFromCurve(curve, camera, {17, 65});
      EXPECT_GT(field.MaxLength(), 10.0);
      for (std::size_t v = 0; v < field.vertices().size(); ++v) {
        EXPECT_LT((field.vertices()[v] - expected->vertices()[v]).norm(), kSameTruth_px);
      }
    }
  }
}

TEST(CurveFromRowRotations, IsTheInverse) {
  const Camera camera = Camera::Pinhole(800, 600, 640.0);
  // Any camera turn whose middle row is the reference.
  const auto turn = [](double row) {
    const double s = (row + 0.5) / 600.0 - 0.5;
    return ExpSo3(Eigen::Vector3d(0.02 * std::sin(5.0 * s), 0.04 * s, 0.01 * s * s));
  };
  const int bands = 48;
  const RotationCurve curve = CurveFromRowRotations(turn, camera, bands);
  const auto rotations = RowRotationsFromCurve(curve, camera, 101);
  for (int i = 0; i < 101; ++i) {
    const double angle =
        rotations[static_cast<std::size_t>(i)].angularDistance(turn(599.0 * i / 100.0));
    // A curvature of c leaves c / 16 / 48^2 between the first two centres and, where it goes on
    // straight, 3/8 c / 48^2 at the edge; c is 0.3.
    EXPECT_LT(angle, i == 0 || i == 100 ? 6e-5 : 1e-5) << i;
  }
  // A camera that yaws to the right from the first row on turns what it sees to the left.
  const RotationCurve yaw = CurveFromRowRotations(
      [](double row) { return ExpSo3(Eigen::Vector3d(0.0, -0.1 * (row / 600.0 - 0.5), 0.0)); },
      camera, 4);
  EXPECT_LT(yaw.back().x(), 0.0);
}

TEST(CurveFromState, ScalesPerChannelAndBack) {
  const std::vector<float> state = {0.1F, 0.2F, -0.3F, 0.4F, 0.5F, -0.6F};
  const Eigen::Vector3d scale(0.04, 0.05, 0.08);
  const RotationCurve curve = CurveFromState(state, scale);
  ASSERT_EQ(curve.size(), 2U);
  EXPECT_LT((curve[0] - Eigen::Vector3d(0.1 * 0.04, -0.3 * 0.05, 0.5 * 0.08)).norm(), 1e-8);
  EXPECT_LT((curve[1] - Eigen::Vector3d(0.2 * 0.04, 0.4 * 0.05, -0.6 * 0.08)).norm(), 1e-8);
  EXPECT_EQ(StateFromCurve(curve, scale), state);
}

TEST(FieldFromCurve, RefusesWhatMakesNoSense) {
  const Camera camera = Camera::Pinhole(64, 48, 60.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(FieldFromCurve({}, camera));
  EXPECT_FALSE(FieldFromCurve({Eigen::Vector3d(0.0, nan, 0.0)}, camera));
  EXPECT_FALSE(FieldFromCurve(Shaking(4), Camera{}));
  EXPECT_FALSE(FieldFromCurve(Shaking(4), camera, {1, 5}));
}

TEST(FieldFromCurve, WorksOnTheSmallestImages) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 7}, std::pair{9, 1}}) {
    const auto field = FieldFromCurve(Shaking(24), Camera::Pinhole(width, height, width), {3, 3});
    ASSERT_TRUE(field);
    EXPECT_TRUE(std::isfinite(field->MaxLength()));
  }
}

}  // namespace
}  // namespace rsstab::rsdiff
