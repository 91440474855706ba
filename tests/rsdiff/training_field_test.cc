// SPDX-License-Identifier: Apache-2.0
// The training data's geometry (rsdiff/train/rotation_curve.py) against igf's, on the curve of
// data/make_training_field.py.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/readout_motion.h"
#include "igf/base/rotation.h"
#include "tests/support/test_paths.h"

namespace rsstab::rsdiff {
namespace {

constexpr int kWidth = 400;
constexpr int kHeight = 300;
constexpr double kFocal_px = 320.0;
// The training code makes its maps in float32 and the file has five digits; a field of tens of
// pixels with another convention anywhere is off by far more.
constexpr double kSame_px = 1e-3;

// The training code keeps a curve as straight lines between these samples.
constexpr int kSamples = 321;
constexpr double kReach = 0.8;

Eigen::Vector3d Stated(double t) {
  return {0.03 * std::sin(5.0 * t), 0.025 * std::sin(3.0 * t + 0.4), 0.08 * t - 0.06 * t * t};
}

Eigen::Vector3d CurveAt(double t) {
  const double position = (t + kReach) / (2.0 * kReach) * (kSamples - 1);
  const double lower = std::floor(position);
  const auto sample = [](double i) -> Eigen::Vector3d {
    return Stated(-kReach + i * 2.0 * kReach / (kSamples - 1)) - Stated(0.0);
  };
  const double share = position - lower;
  return (1.0 - share) * sample(lower) + share * sample(lower + 1.0);
}

struct Row {
  Eigen::Vector2d pixel, gs, rs;
};

std::vector<Row> ReadTable() {
  std::ifstream file(testing::SourceFile("tests/rsdiff/data/training_field.csv"));
  std::string line;
  std::getline(file, line);
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    Row row;
    numbers >> row.pixel.x() >> row.pixel.y() >> row.gs.x() >> row.gs.y() >> row.rs.x() >>
        row.rs.y();
    EXPECT_TRUE(numbers) << line;
    rows.push_back(row);
  }
  return rows;
}

TEST(TrainingField, AgreesWithIgf) {
  const Camera camera = Camera::Pinhole(kWidth, kHeight, kFocal_px);
  std::vector<Eigen::Quaterniond> row_from_middle;
  for (int row = 0; row < kHeight; ++row) {
    const Eigen::Vector3d curve = CurveAt((row + 0.5) / kHeight - 0.5);
    row_from_middle.push_back(ExpSo3(Eigen::Vector3d(-curve.y() * kHeight / kFocal_px,
                                                     curve.x() * kHeight / kFocal_px, curve.z())));
  }
  const auto motion = ReadoutMotion::Create(camera, row_from_middle);
  ASSERT_TRUE(motion) << motion.error().message;

  const std::vector<Row> table = ReadTable();
  ASSERT_GT(table.size(), 50U);
  double largest_px = 0.0;
  for (const Row& row : table) {
    const auto gs = motion->GsFromRs(row.pixel);
    const auto rs = motion->RsFromGs(row.pixel);
    ASSERT_TRUE(gs && rs);
    EXPECT_LT((*gs - row.gs).norm(), kSame_px) << row.pixel.transpose();
    EXPECT_LT((*rs - row.rs).norm(), kSame_px) << row.pixel.transpose();
    largest_px = std::max(largest_px, (row.rs - row.pixel).norm());
  }
  EXPECT_GT(largest_px, 5.0) << "a table without motion would agree with anything";
}

}  // namespace
}  // namespace rsstab::rsdiff
