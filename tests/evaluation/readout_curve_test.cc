// SPDX-License-Identifier: Apache-2.0
#include "evaluation/readout_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/spread_coverage.h"
#include "evaluation/synthetic_sample.h"
#include "rsdiff/rotation_curve.h"
#include "stabilizer/metrics/field_metrics.h"

namespace rsstab::evaluation {
namespace {

Camera TestCamera(double focal_px = 700.0) { return Camera::Pinhole(800, 600, focal_px); }

TEST(ReadoutCurve, IsZeroAtTheMiddleRow) {
  SeededRandom random(3);
  for (const MotionClass motion_class : kMovingClasses) {
    const ReadoutCurve curve = DrawCurve(motion_class, random);
    EXPECT_LT(curve.AtRow(299.5, 600).norm(), 1e-12) << MotionClassName(motion_class);
  }
}

// The example of docs/conventions.md: a yaw to the right, read out top to bottom, has the picture
// move left while it is read; so rows below the middle are displaced to the left.
TEST(ReadoutCurve, DirectionsAreThoseOfTheConventions) {
  ReadoutCurve curve;
  curve.steady.x() = -0.03;  // the scene moves left with time
  MotionField field = TruthField(curve, TestCamera()).value();
  EXPECT_GT(field.Sample({400.0, 0.0}).x(), 5.0);
  EXPECT_LT(field.Sample({400.0, 599.0}).x(), -5.0);
  EXPECT_NEAR(field.Sample({400.0, 599.0}).x(), -0.03 * 599.0 / 2.0, 0.1);
  curve.top_to_bottom = false;
  field = TruthField(curve, TestCamera()).value();
  EXPECT_LT(field.Sample({400.0, 0.0}).x(), -5.0);

  ReadoutCurve down;
  down.steady.y() = 0.03;
  field = TruthField(down, TestCamera()).value();
  EXPECT_LT(field.Sample({400.0, 0.0}).y(), -5.0);
  EXPECT_GT(field.Sample({400.0, 599.0}).y(), 5.0);

  // A positive roll about the axis that looks forward takes the right-hand side down.
  ReadoutCurve roll;
  roll.steady.z() = 0.05;
  field = TruthField(roll, TestCamera()).value();
  EXPECT_GT(field.Sample({799.0, 500.0}).y(), 3.0);
  EXPECT_LT(field.Sample({0.0, 500.0}).y(), -3.0);
}

// Truth and rsdiff state the same motion by codes of their own; they must mean the same.
TEST(ReadoutCurve, AgreesWithTheCurvesOfTheNetworks) {
  // 24 bands follow a curve of up to 3 cycles to a few percent of its swing.
  constexpr double kBandError_px = 0.6;
  SeededRandom random(11);
  for (const MotionClass motion_class : kMovingClasses) {
    const Camera camera = TestCamera();
    ReadoutCurve curve = DrawCurve(motion_class, random);
    ASSERT_TRUE(ScaleToMeanLength(curve, camera, 8.0));
    const MotionField truth = TruthField(curve, camera).value();
    const MotionField from_bands =
        rsdiff::FieldFromCurve(BandsOfCurve(curve, 24), camera, {33, 129}).value();
    EXPECT_LT(stabilizer::EndPointError(from_bands, truth).value(), kBandError_px)
        << MotionClassName(motion_class);
    const rsdiff::RotationCurve read_back = rsdiff::CurveFromRowRotations(
        [&](double row) { return curve.RowRotation(camera, row); }, camera, 24);
    const rsdiff::RotationCurve bands = BandsOfCurve(curve, 24);
    for (std::size_t band = 0; band < bands.size(); ++band) {
      EXPECT_LT((read_back[band] - bands[band]).norm(), 1e-9) << band;
    }
  }
}

TEST(ReadoutCurve, ClassesMoveWhatTheyAreDefinedToMove) {
  SeededRandom random(2);
  for (int i = 0; i < 50; ++i) {
    const ReadoutCurve skew = DrawCurve(MotionClass::kSkewTwist, random);
    EXPECT_EQ(skew.steady.y(), 0.0);
    EXPECT_EQ(skew.acceleration.norm(), 0.0);
    EXPECT_EQ(skew.tones[0].amplitude, 0.0);
    const ReadoutCurve stretch = DrawCurve(MotionClass::kStretch, random);
    EXPECT_EQ(std::abs(stretch.steady.y()), 1.0);
    EXPECT_EQ(stretch.steady.x(), 0.0);
    EXPECT_EQ(stretch.steady.z(), 0.0);
    const ReadoutCurve oscillation = DrawCurve(MotionClass::kOscillation, random);
    EXPECT_EQ(oscillation.steady.norm(), 0.0);
    for (const Tone& tone : oscillation.tones) {
      EXPECT_GE(tone.cycles, 0.5);
      EXPECT_LE(tone.cycles, 3.0);
      EXPECT_NE(tone.amplitude, 0.0);
    }
    const ReadoutCurve mixed = DrawCurve(MotionClass::kMixed, random);
    EXPECT_GT(mixed.steady.norm(), 0.0);
    EXPECT_GT(mixed.acceleration.norm(), 0.0);
    EXPECT_NE(mixed.tones[2].amplitude, 0.0);
    EXPECT_EQ(DrawCurve(MotionClass::kStill, random).AtTime(0.5).norm(), 0.0);
  }
}

TEST(ReadoutCurve, BothReadoutDirectionsAreDrawn) {
  SeededRandom random(4);
  int down = 0;
  for (int i = 0; i < 400; ++i) {
    down += DrawCurve(MotionClass::kMixed, random).top_to_bottom ? 1 : 0;
  }
  EXPECT_NEAR(down, 200, 50);  // five standard deviations
}

TEST(ReadoutCurve, MeanLengthIsReached) {
  SeededRandom random(8);
  for (const double focal_px : {400.0, 1600.0}) {
    for (const MotionClass motion_class : kMovingClasses) {
      const Camera camera = TestCamera(focal_px);
      ReadoutCurve curve = DrawCurve(motion_class, random);
      ASSERT_TRUE(ScaleToMeanLength(curve, camera, 7.5));
      const auto displacement = PixelDisplacements(TruthField(curve, camera).value());
      const auto valid = SourcesInside(displacement, camera.width, camera.height);
      const std::vector<Eigen::Vector2f> zero(displacement.size(), Eigen::Vector2f::Zero());
      // The strength is found on a grid of 41 x 61 pixels.
      EXPECT_NEAR(stabilizer::EndPointError(zero, displacement, valid).value(), 7.5, 0.05)
          << MotionClassName(motion_class) << " " << focal_px;
    }
  }
}

TEST(ReadoutCurve, WhatDoesNotMoveCannotBeScaled) {
  ReadoutCurve still;
  const Status status = ScaleToMeanLength(still, TestCamera(), 5.0);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace rsstab::evaluation
