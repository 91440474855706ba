// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/spatial_modes.h"

#include <gtest/gtest.h>

namespace rsstab::stabilizer {
namespace {

constexpr int kColumns = 6;
constexpr int kRows = 4;

// sum over neighbouring vertices of |U_i - U_j|^2, each pair once
double NeighbourEnergy(const std::vector<Eigen::Vector2d>& u) {
  const auto at = [&](int c, int r) { return u[static_cast<std::size_t>(r * (kColumns + 1) + c)]; };
  double sum = 0.0;
  for (int r = 0; r <= kRows; ++r) {
    for (int c = 0; c <= kColumns; ++c) {
      if (c < kColumns) {
        sum += (at(c, r) - at(c + 1, r)).squaredNorm();
      }
      if (r < kRows) {
        sum += (at(c, r) - at(c, r + 1)).squaredNorm();
      }
    }
  }
  return sum;
}

TEST(SpatialModes, DiagonaliseTheNeighbourTerm) {
  const SpatialModes modes(kColumns, kRows, 20);
  ASSERT_EQ(modes.count(), static_cast<std::size_t>((kColumns + 1) * (kRows + 1)));
  std::vector<Eigen::Vector2d> coefficients(modes.count());
  double expected = 0.0;
  for (std::size_t k = 0; k < modes.count(); ++k) {
    coefficients[k] = Eigen::Vector2d(0.3 * static_cast<double>(k % 5) - 0.4, 0.1);
    expected += modes.stiffness(k) * coefficients[k].squaredNorm();
  }
  EXPECT_NEAR(NeighbourEnergy(modes.Synthesize(coefficients)), expected, 1e-9);
}

TEST(SpatialModes, AnalyzeInvertsSynthesize) {
  const SpatialModes modes(16, 16, 5);
  EXPECT_EQ(modes.count(), 21U);
  std::vector<Eigen::Vector2d> coefficients(modes.count());
  for (std::size_t k = 0; k < modes.count(); ++k) {
    coefficients[k] = Eigen::Vector2d(static_cast<double>(k), -1.0);
  }
  const auto back = modes.Analyze(modes.Synthesize(coefficients));
  for (std::size_t k = 0; k < modes.count(); ++k) {
    EXPECT_LT((back[k] - coefficients[k]).norm(), 1e-9);
  }
}

TEST(SpatialModes, TheFirstIsAShiftOfEverything) {
  const SpatialModes modes(kColumns, kRows, 3);
  EXPECT_EQ(modes.stiffness(0), 0.0);
  std::vector<Eigen::Vector2d> coefficients(modes.count(), Eigen::Vector2d::Zero());
  coefficients[0] = {1.0, 0.0};
  const auto vertices = modes.Synthesize(coefficients);
  for (const Eigen::Vector2d& v : vertices) {
    EXPECT_NEAR(v.x(), vertices.front().x(), 1e-12);
  }
}

}  // namespace
}  // namespace rsstab::stabilizer
