// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/mesh_grid.h"

#include <algorithm>

namespace rsstab::stabilizer {

Eigen::Vector2d MeshGrid::VertexPosition(int column, int row) const {
  return {static_cast<double>(column) / columns_ - 0.5,
          (static_cast<double>(row) / rows_ - 0.5) * aspect_};
}

std::array<int, 4> MeshGrid::CellVertices(int cell) const {
  const int column = cell % columns_;
  const int row = cell / columns_;
  const int top_left = VertexIndex(column, row);
  const int bottom_left = VertexIndex(column, row + 1);
  return {top_left, top_left + 1, bottom_left, bottom_left + 1};
}

MeshGrid::Location MeshGrid::Locate(const Eigen::Vector2d& point) const {
  const double gx = std::clamp((point.x() + 0.5) * columns_, 0.0, static_cast<double>(columns_));
  const double gy =
      std::clamp((point.y() / aspect_ + 0.5) * rows_, 0.0, static_cast<double>(rows_));
  const int column = std::min(static_cast<int>(gx), columns_ - 1);
  const int row = std::min(static_cast<int>(gy), rows_ - 1);
  const double fx = gx - column;
  const double fy = gy - row;
  return {row * columns_ + column,
          {(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy}};
}

}  // namespace rsstab::stabilizer
