// SPDX-License-Identifier: Apache-2.0
#include "igf/base/readout_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "igf/base/rotation.h"

namespace rsstab {
namespace {

// A camera that turns evenly during readout, identity at the middle row.
std::vector<Eigen::Quaterniond> Turning(const Eigen::Vector3d& from_top_to_bottom_rad, int count) {
  std::vector<Eigen::Quaterniond> rotations;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1) - 0.5;
    rotations.push_back(ExpSo3(Eigen::Vector3d(share * from_top_to_bottom_rad)));
  }
  return rotations;
}

TEST(ReadoutMotion, MovesPixelsWithTheirRowsRotation) {
  const Camera camera = Camera::Pinhole(801, 601, 700.0);
  const ReadoutMotion motion = *ReadoutMotion::Create(camera, Turning({0.0, 0.02, 0.0}, 601));
  // The rotation about y takes the axis to the right: exp([w]x) (0,0,1) = (w_y, ..).
  const auto bottom = motion.GsFromRs({400.0 + 700.0 * std::tan(0.01), 600.0});
  ASSERT_TRUE(bottom);
  EXPECT_NEAR(bottom->x(), 400.0, 1e-6);
  EXPECT_LT((*motion.RsFromGs({123.0, 300.0}) - Eigen::Vector2d(123.0, 300.0)).norm(), 1e-9);
  for (const Eigen::Vector2d& gs : {Eigen::Vector2d(30.0, 50.0), Eigen::Vector2d(700.0, 520.0)}) {
    EXPECT_LT((*motion.GsFromRs(*motion.RsFromGs(gs)) - gs).norm(), 1e-3);
  }
}

TEST(ReadoutMotion, NeedsTwoFiniteRotations) {
  const Camera camera = Camera::Pinhole(64, 48, 60.0);
  std::vector<Eigen::Quaterniond> rotations = Turning({0.0, 0.0, 0.1}, 5);
  EXPECT_FALSE(ReadoutMotion::Create(Camera{}, rotations));
  EXPECT_FALSE(ReadoutMotion::Create(camera, std::span(rotations).first(1)));
  rotations[2].x() = std::numeric_limits<double>::quiet_NaN();
  const auto motion = ReadoutMotion::Create(camera, rotations);
  ASSERT_FALSE(motion);
  EXPECT_EQ(motion.error().code, ErrorCode::kInvalidArgument);
}

TEST(ComputeReadoutField, SamplesRsFromGsAtItsVertices) {
  const Camera camera = Camera::Pinhole(640, 360, 500.0);
  const ReadoutMotion motion = *ReadoutMotion::Create(camera, Turning({0.02, -0.03, 0.05}, 257));
  const MotionField field = *ComputeReadoutField(camera, motion, {9, 13});
  EXPECT_EQ(field.columns(), 9);
  EXPECT_EQ(field.rows(), 13);
  EXPECT_EQ(field.reference_row(), 179.5);
  for (int row = 0; row < 13; ++row) {
    for (int column = 0; column < 9; ++column) {
      const Eigen::Vector2d x = field.VertexPosition(column, row);
      EXPECT_LT((*motion.RsFromGs(x) - x - field.At(column, row).cast<double>()).norm(), 1e-5);
    }
  }
  EXPECT_FALSE(ComputeReadoutField(camera, motion, {1, 13}));
}

// Where the map says nothing, the displacement of the nearest point towards the middle holds.
TEST(FillField, CarriesOnWhereThereIsNoRay) {
  const Camera camera = Camera::Pinhole(200, 100, 150.0);
  MotionField field = *MakeField(camera, {21, 11});
  FillField(
      camera,
      [](const Eigen::Vector2d& p) -> std::optional<Eigen::Vector2d> {
        if (p.x() > 150.0) {
          return std::nullopt;
        }
        return p + Eigen::Vector2d(p.x(), 1.0);
      },
      field);
  EXPECT_NEAR(field.At(0, 5).x(), 0.0F, 1e-4F);
  EXPECT_NEAR(field.At(20, 5).x(), 150.0F, 3.0F);  // steps of 3% towards the middle
  EXPECT_EQ(field.At(20, 5).y(), 1.0F);
}

}  // namespace
}  // namespace rsstab
