// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_MOTION_FIELD_H_
#define RSSTAB_IGF_BASE_MOTION_FIELD_H_

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rsstab {

// Backward displacement G of an image's readout, in pixels of width() x height():
//   I_GS(x) = I_RS(x + G(x)),  x on the corrected image's grid.
// Stored on a regular grid of vertices, row by row, corners of the grid on the centres of the
// corner pixels ("align corners"); bilinear in between, clamped outside. G = 0 on reference_row().
class MotionField {
 public:
  MotionField() = default;
  // Zero field. columns, rows >= 2; width, height >= 1. The reference row is the middle one,
  // (height - 1) / 2, unless given.
  MotionField(int width, int height, int columns, int rows);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double reference_row() const { return reference_row_; }
  void set_reference_row(double row) { reference_row_ = row; }

  // Pixel position of a vertex.
  [[nodiscard]] Eigen::Vector2d VertexPosition(int column, int row) const;
  [[nodiscard]] const Eigen::Vector2f& At(int column, int row) const {
    return displacement_[Index(column, row)];
  }
  [[nodiscard]] Eigen::Vector2f& At(int column, int row) {
    return displacement_[Index(column, row)];
  }
  // All vertices, row by row.
  [[nodiscard]] std::span<const Eigen::Vector2f> vertices() const { return displacement_; }
  [[nodiscard]] std::span<Eigen::Vector2f> vertices() { return displacement_; }

  // Displacement at a pixel, bilinear, clamped to the grid.
  [[nodiscard]] Eigen::Vector2d Sample(const Eigen::Vector2d& pixel) const;

  // The same motion stated for another image size: displacements scale per axis, the grid stays.
  [[nodiscard]] MotionField Rescaled(int new_width, int new_height) const;

  // Root mean square and largest length over the vertices, px.
  [[nodiscard]] double RmsLength() const;
  [[nodiscard]] double MaxLength() const;

 private:
  [[nodiscard]] std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  int width_ = 0;
  int height_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  double reference_row_ = 0.0;
  std::vector<Eigen::Vector2f> displacement_;
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_MOTION_FIELD_H_
