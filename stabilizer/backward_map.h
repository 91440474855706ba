// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_BACKWARD_MAP_H_
#define RSSTAB_STABILIZER_BACKWARD_MAP_H_

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"

namespace rsstab::stabilizer {

// Everything that rendering needs to know about one frame, in pixels of width x height (x right,
// y down, centres at integers). Backward throughout: from an output pixel q to the recorded pixel
// that shows the same thing,
//   r = rectified_from_output q            (projective)
//   r = r + mesh_update(r)
//   p = distort(r)                         (only with a lens)
//   source = p + rs_field(p)
struct FrameWarp {
  int width = 0;
  int height = 0;
  // Crop, zoom and the global path update in one: output pixel -> pixel of the rectified picture
  // (global shutter, seen through the pinhole K of `lens` where a lens is given).
  Eigen::Matrix3d rectified_from_output = Eigen::Matrix3d::Identity();
  // What the local paths add to the global one, sampled at the rectified pixel. No vertices (a
  // default-made field) = nothing.
  MotionField mesh_update;
  // The lens that bent the recorded picture, at this size; empty when the picture is a pinhole's.
  std::optional<Camera> lens;
  // Motion during readout, stated on the recorded (distorted) picture's grid. No vertices = global
  // shutter.
  MotionField rs_field;
};

// Absolute source positions, in pixels of width() x height(), of the pixels of an output picture of
// the same size: I_out(q) = I_source(map(q)). Stored on a regular vertex grid, row by row, corners
// of the grid on the centres of the corner pixels; bilinear in between, extended linearly outside.
// Const methods are safe from any thread.
class BackwardMap {
 public:
  BackwardMap() = default;
  // The identity. width, height >= 1; columns, rows >= 2.
  BackwardMap(int width, int height, int columns, int rows);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }

  // Output pixel of a vertex.
  [[nodiscard]] Eigen::Vector2d VertexPosition(int column, int row) const;
  [[nodiscard]] const Eigen::Vector2f& At(int column, int row) const {
    return source_[Index(column, row)];
  }
  [[nodiscard]] Eigen::Vector2f& At(int column, int row) { return source_[Index(column, row)]; }
  // All vertices, row by row.
  [[nodiscard]] std::span<const Eigen::Vector2f> vertices() const { return source_; }

  // Source position of an output pixel.
  [[nodiscard]] Eigen::Vector2d Sample(const Eigen::Vector2d& output_pixel) const;

 private:
  [[nodiscard]] std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  int width_ = 0;
  int height_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Eigen::Vector2f> source_;
};

// The chain of FrameWarp for one output pixel, exactly. Empty where a step has no answer: beyond
// the horizon of the homography, or where the lens folds.
[[nodiscard]] std::optional<Eigen::Vector2d> SourcePosition(const FrameWarp& warp,
                                                            const Eigen::Vector2d& output_pixel);

struct MapGrid {
  int columns = 2;
  int rows = 2;
};

// The coarsest grid between whose vertices bilinear interpolation stays within 0.02 px of the
// exact map, for the fastest motion that is expected; the .cc gives the argument.
[[nodiscard]] MapGrid DefaultMapGrid(int width, int height);

// Evaluates the chain on the vertices of a grid. Vertices without a source lie far outside the
// picture. The fields and the lens of `warp` must be stated for its width x height.
[[nodiscard]] BackwardMap ComposeBackwardMap(const FrameWarp& warp, MapGrid grid);
[[nodiscard]] BackwardMap ComposeBackwardMap(const FrameWarp& warp);

// How far, in pixels, the worst output pixel's source lies outside the rectangle of pixel centres
// [0, width-1] x [0, height-1] of the source; the larger of the two axes. <= 0 means that every
// output pixel has a source, with that much to spare. Exact for the map as it is rendered: within a
// cell each coordinate is linear along x and along y, so its extremes over a cell, and so over the
// picture, lie on vertices. Infinite when a vertex is not a number.
[[nodiscard]] double OverhangPx(const BackwardMap& map);

// Share of output pixels, in [0, 1], whose source lies outside that rectangle; 0 whenever
// OverhangPx() <= 0.
[[nodiscard]] double UndefinedShare(const BackwardMap& map);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_BACKWARD_MAP_H_
