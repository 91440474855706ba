// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/mesh_motion.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "igf/base/homography.h"
#include "stabilizer/normalized_coordinates.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kAspect = 0.5625;
constexpr double kPx = 1.0 / kReferenceWidthPx;

// Parallax-like: a smooth local motion of 1.5 px.
Eigen::Vector2d LocalMotion(const Eigen::Vector2d& p) {
  return {1.5 * kPx * std::sin(2.0 * std::numbers::pi * p.x()), 1.0 * kPx * std::cos(3.0 * p.y())};
}

std::vector<RectifiedMatch> Matches(const Eigen::Matrix3d& h, int count, bool local) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::vector<RectifiedMatch> matches;
  for (int i = 0; i < count; ++i) {
    RectifiedMatch m;
    m.from = {unit(random), unit(random) * kAspect};
    m.to = Project(h, m.from);
    if (local) {
      m.to += LocalMotion(m.from);
    }
    matches.push_back(m);
  }
  return matches;
}

Eigen::Matrix3d SomeMotion() {
  Eigen::Matrix3d h;
  h << 1.0, -0.004, 0.012, 0.004, 1.0, -0.008, 0.01, 0.0, 1.0;
  return h;
}

TEST(MeshGrid, BilinearWeightsReproduceThePoint) {
  const MeshGrid grid(16, 9, kAspect);
  const Eigen::Vector2d p(0.123, -0.077);
  const auto location = grid.Locate(p);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const auto vertices = grid.CellVertices(location.cell);
  for (std::size_t i = 0; i < 4; ++i) {
    sum += location.weights[i] * grid.VertexPosition(vertices[i] % (grid.columns() + 1),
                                                     vertices[i] / (grid.columns() + 1));
  }
  EXPECT_LT((sum - p).norm(), 1e-12);
}

TEST(MeshMotion, NoLocalMotionGivesNone) {
  MeshMotionSolver solver(MeshGrid(16, 16, kAspect));
  for (const Eigen::Vector2d& d : solver.Solve(Matches(SomeMotion(), 400, false), SomeMotion())) {
    EXPECT_LT(d.norm(), 1e-9);
  }
}

TEST(MeshMotion, FollowsSmoothLocalMotion) {
  const MeshGrid grid(16, 16, kAspect);
  MeshMotionSolver solver(grid);
  const auto displacement = solver.Solve(Matches(SomeMotion(), 500, true), SomeMotion());
  ASSERT_EQ(displacement.size(), static_cast<std::size_t>(grid.num_vertices()));
  double sum_error = 0.0;
  double sum_truth = 0.0;
  for (int r = 2; r <= 14; ++r) {
    for (int c = 2; c <= 14; ++c) {
      const Eigen::Vector2d truth = LocalMotion(grid.VertexPosition(c, r));
      sum_truth += truth.squaredNorm();
      sum_error +=
          (displacement[static_cast<std::size_t>(grid.VertexIndex(c, r))] - truth).squaredNorm();
    }
  }
  // The shape term costs some amplitude; most of the motion must be there.
  EXPECT_LT(std::sqrt(sum_error), 0.3 * std::sqrt(sum_truth));
}

TEST(MeshMotion, LeavesOutWhatMovesUnlikeItsNeighbours) {
  MeshMotionSolver solver(MeshGrid(16, 16, kAspect));
  auto matches = Matches(SomeMotion(), 400, false);
  for (std::size_t i = 0; i < matches.size(); i += 5) {
    matches[i].to += Eigen::Vector2d(i % 2 == 0 ? 3.0 * kPx : 60.0 * kPx, 0.0);
  }
  for (const Eigen::Vector2d& d : solver.Solve(matches, SomeMotion())) {
    EXPECT_LT(d.norm(), 0.05 * kPx);
  }
}

TEST(MeshMotion, TooFewMatchesGiveNone) {
  MeshMotionSolver solver(MeshGrid(16, 16, kAspect));
  EXPECT_TRUE(solver.Solve(Matches(SomeMotion(), 5, true), SomeMotion()).empty());
}

TEST(MeshMotion, CellHomographyMovesItsVertices) {
  const MeshGrid grid(4, 4, kAspect);
  std::vector<Eigen::Vector2d> displacement(static_cast<std::size_t>(grid.num_vertices()),
                                            Eigen::Vector2d::Zero());
  displacement[static_cast<std::size_t>(grid.VertexIndex(1, 1))] = {2.0 * kPx, -kPx};
  const Eigen::Matrix3d h = CellHomography(grid, 0, SomeMotion(), displacement);
  const Eigen::Vector2d vertex = grid.VertexPosition(1, 1);
  const Eigen::Vector2d expected = Project(SomeMotion(), vertex) + Eigen::Vector2d(2.0 * kPx, -kPx);
  EXPECT_LT((Project(h, vertex) - expected).norm(), 1e-9);
  EXPECT_LT((CellHomography(grid, 15, SomeMotion(), displacement) - SomeMotion()).norm(), 1e-8);
}

}  // namespace
}  // namespace rsstab::stabilizer
