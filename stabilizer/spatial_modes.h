// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_SPATIAL_MODES_H_
#define RSSTAB_STABILIZER_SPATIAL_MODES_H_

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rsstab::stabilizer {

// The cosine modes of a mesh's vertices: eigenvectors of its neighbour term. In this basis
//   sum_i sum_{j in N(i)} |U_i - U_j|^2 = 2 sum_k stiffness_k |u_k|^2,
// so the neighbour term of the bundled paths (Liu et al. 2013, eq. 4) no longer couples paths, and
// every mode is smoothed in time by itself. Modes that the term damps away are left out.
class SpatialModes {
 public:
  // columns, rows: cells of the mesh. Keeps modes (i, j) with i + j <= max_order.
  SpatialModes(int columns, int rows, int max_order);

  [[nodiscard]] std::size_t count() const { return stiffness_.size(); }
  [[nodiscard]] double stiffness(std::size_t mode) const { return stiffness_[mode]; }

  // Vertex displacements -> mode coefficients (orthonormal projection), and back.
  [[nodiscard]] std::vector<Eigen::Vector2d> Analyze(
      std::span<const Eigen::Vector2d> vertices) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> Synthesize(
      std::span<const Eigen::Vector2d> coefficients) const;

 private:
  std::vector<double> stiffness_;
  Eigen::MatrixXd basis_;  // vertices x modes, orthonormal columns
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_SPATIAL_MODES_H_
