// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_MESH_GRID_H_
#define RSSTAB_STABILIZER_MESH_GRID_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace rsstab::stabilizer {

// A regular grid of columns x rows cells over the whole picture, in normalised coordinates
// (normalized_coordinates.h): 1 wide, `aspect` = height / width high.
class MeshGrid {
 public:
  // columns, rows >= 1; aspect > 0.
  MeshGrid(int columns, int rows, double aspect)
      : columns_(columns), rows_(rows), aspect_(aspect) {}

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double aspect() const { return aspect_; }
  [[nodiscard]] int num_cells() const { return columns_ * rows_; }
  // Vertices are counted row by row from the top left.
  [[nodiscard]] int num_vertices() const { return (columns_ + 1) * (rows_ + 1); }
  [[nodiscard]] int VertexIndex(int column, int row) const { return row * (columns_ + 1) + column; }
  [[nodiscard]] Eigen::Vector2d VertexPosition(int column, int row) const;

  // The four vertices of a cell: top left, top right, bottom left, bottom right.
  [[nodiscard]] std::array<int, 4> CellVertices(int cell) const;

  // A point as a bilinear mix of its cell's vertices (weights sum to 1); points outside are clamped
  // to the border.
  struct Location {
    int cell = 0;
    std::array<double, 4> weights{};
  };
  [[nodiscard]] Location Locate(const Eigen::Vector2d& point) const;

 private:
  int columns_;
  int rows_;
  double aspect_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_MESH_GRID_H_
