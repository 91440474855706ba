// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_MESH_MOTION_H_
#define RSSTAB_STABILIZER_MESH_MOTION_H_

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "stabilizer/global_motion.h"
#include "stabilizer/mesh_grid.h"

namespace rsstab::stabilizer {

// Motion between two frames that one homography cannot tell (parallax, what electronic
// stabilisation left behind): a displacement per mesh vertex, on top of the global motion.
//
// Bundled camera paths (Liu et al. 2013), section 3: the vertices move such that tracks keep their
// bilinear coordinates in their cell, and cells deform as similarly as possible to the mesh moved
// by the global homography:
//   E = sum_k |w_k^T V - r_k|^2 + sum_cells alpha_c sum_triangles |similarity(V)|^2
// Departures: the unknown is the displacement V beyond the global homography; alpha is not one
// number per frame chosen by a search but falls, cell by cell, with the number of tracks that
// support it, which serves the same end at the price of one solve.
class MeshMotionSolver {
 public:
  explicit MeshMotionSolver(const MeshGrid& grid);
  ~MeshMotionSolver();
  MeshMotionSolver(const MeshMotionSolver&) = delete;
  MeshMotionSolver& operator=(const MeshMotionSolver&) = delete;

  // Displacements in normalised units, one per vertex of the later frame's grid seen from the
  // earlier one: a point p of the earlier frame moves to to_from(p) + V(p). Matches far from the
  // global motion, or from what their neighbours do, are left out. Empty when fewer than a dozen
  // matches remain. Not thread safe (keeps its factorisation); one per thread.
  [[nodiscard]] std::vector<Eigen::Vector2d> Solve(std::span<const RectifiedMatch> matches,
                                                   const Eigen::Matrix3d& to_from);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The homography of one cell, from its four vertices under global motion plus displacement: F_i(t)
// of the paper, earlier frame -> later frame. Falls back to `to_from` when the cell folds.
[[nodiscard]] Eigen::Matrix3d CellHomography(const MeshGrid& grid, int cell,
                                             const Eigen::Matrix3d& to_from,
                                             std::span<const Eigen::Vector2d> displacement);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_MESH_MOTION_H_
