// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/backward_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "igf/base/homography.h"

namespace rsstab::stabilizer {
namespace {

// Where vertices without a source go: outside any picture, yet small enough for float arithmetic.
constexpr float kFarOutside = -1e6F;

// Linear interpolation between vertices h apart misses a curve f by at most h^2/8 max|f''|.
//
// Rows: 60 Hz vibration during a readout of 30 ms is 1.8 cycles down the frame; with an amplitude
// of 15 px at 1080 rows, |f''| = 15 (2 pi 1.8 / 1080)^2 = 1.6e-3 / px, so that 8 px between rows
// cost 0.013 px. Columns: readout motion is smooth along a row, what bends it is perspective: a
// tilt of 10 degrees at f = 0.8 W gives |f''| = 2 tan(10 deg) / f, about 2.3e-4 / px at 1920, and
// up to 1.5 times that in the corners; 16 px between columns cost 0.011 px. The same motion in
// another picture size has displacements in proportion to it and |f''| in inverse proportion, so
// equal error in pixels wants a spacing in proportion to the root of the size.
constexpr double kRowSpacingPx = 8.0;
constexpr double kRowSpacingHeight = 1080.0;
constexpr double kColumnSpacingPx = 16.0;
constexpr double kColumnSpacingWidth = 1920.0;

int VerticesAlong(int size, double spacing_px, double at_size) {
  const double spacing = spacing_px * std::sqrt(size / at_size);
  return std::max(2, static_cast<int>(std::ceil((size - 1) / spacing)) + 1);
}

// A coordinate on a side of `size` pixels and `vertices` vertices: cell and position in it.
struct CellPosition {
  int cell;
  double fraction;  // below 0 or above 1 outside the grid
};
CellPosition Locate(double pixel, int size, int vertices) {
  // A one-pixel side has all its vertices on that pixel.
  const double g = size > 1 ? pixel * (vertices - 1) / (size - 1) : 0.0;
  const int cell = static_cast<int>(std::clamp(std::floor(g), 0.0, vertices - 2.0));
  return {cell, g - cell};
}

// Distance of a source position from the rectangle of pixel centres, negative inside.
double Overhang(const Eigen::Vector2d& source, int width, int height) {
  return std::max({-source.x(), source.x() - (width - 1), -source.y(), source.y() - (height - 1)});
}

// False for NaN.
bool IsInside(const Eigen::Vector2d& source, int width, int height) {
  return source.x() >= 0.0 && source.x() <= width - 1.0 && source.y() >= 0.0 &&
         source.y() <= height - 1.0;
}

// The chain of one FrameWarp, ready for many points.
class WarpChain {
 public:
  explicit WarpChain(const FrameWarp& warp) : warp_(warp) {
    if (warp.lens) {
      projector_.emplace(*warp.lens);
      k_inverse_ = warp.lens->K().inverse();
    }
  }

  [[nodiscard]] std::optional<Eigen::Vector2d> SourceOf(const Eigen::Vector2d& output_pixel) const {
    std::optional<Eigen::Vector2d> point =
        ProjectChecked(warp_.rectified_from_output, output_pixel);
    if (point && warp_.mesh_update.columns() > 0) {
      *point += warp_.mesh_update.Sample(*point);
    }
    if (point && projector_) {
      point = projector_->ProjectRay(k_inverse_ * point->homogeneous());
    }
    if (point && warp_.rs_field.columns() > 0) {
      *point += warp_.rs_field.Sample(*point);
    }
    return point;
  }

 private:
  const FrameWarp& warp_;
  std::optional<CameraProjector> projector_;
  Eigen::Matrix3d k_inverse_;
};

}  // namespace

BackwardMap::BackwardMap(int width, int height, int columns, int rows)
    : width_(width),
      height_(height),
      columns_(columns),
      rows_(rows),
      source_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      At(column, row) = VertexPosition(column, row).cast<float>();
    }
  }
}

Eigen::Vector2d BackwardMap::VertexPosition(int column, int row) const {
  return {static_cast<double>(column) * (width_ - 1) / (columns_ - 1),
          static_cast<double>(row) * (height_ - 1) / (rows_ - 1)};
}

Eigen::Vector2d BackwardMap::Sample(const Eigen::Vector2d& output_pixel) const {
  const auto [column, fx] = Locate(output_pixel.x(), width_, columns_);
  const auto [row, fy] = Locate(output_pixel.y(), height_, rows_);
  // a + f (b - a) never leaves [a, b]: differences of float coordinates are exact in double.
  const auto along_row = [this, column = column, fx = fx](int r) -> Eigen::Vector2d {
    const Eigen::Vector2d left = At(column, r).cast<double>();
    return left + fx * (At(column + 1, r).cast<double>() - left);
  };
  const Eigen::Vector2d top = along_row(row);
  return top + fy * (along_row(row + 1) - top);
}

std::optional<Eigen::Vector2d> SourcePosition(const FrameWarp& warp,
                                              const Eigen::Vector2d& output_pixel) {
  return WarpChain(warp).SourceOf(output_pixel);
}

MapGrid DefaultMapGrid(int width, int height) {
  return {VerticesAlong(width, kColumnSpacingPx, kColumnSpacingWidth),
          VerticesAlong(height, kRowSpacingPx, kRowSpacingHeight)};
}

BackwardMap ComposeBackwardMap(const FrameWarp& warp, MapGrid grid) {
  BackwardMap map(warp.width, warp.height, grid.columns, grid.rows);
  const WarpChain chain(warp);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto source = chain.SourceOf(map.VertexPosition(column, row));
      map.At(column, row) = source && source->allFinite()
                                ? Eigen::Vector2f(source->cast<float>())
                                : Eigen::Vector2f(kFarOutside, kFarOutside);
    }
  }
  return map;
}

BackwardMap ComposeBackwardMap(const FrameWarp& warp) {
  return ComposeBackwardMap(warp, DefaultMapGrid(warp.width, warp.height));
}

double OverhangPx(const BackwardMap& map) {
  double worst = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2f& source : map.vertices()) {
    if (!source.allFinite()) {
      return std::numeric_limits<double>::infinity();
    }
    worst = std::max(worst, Overhang(source.cast<double>(), map.width(), map.height()));
  }
  return worst;
}

double UndefinedShare(const BackwardMap& map) {
  if (OverhangPx(map) <= 0.0) {
    return 0.0;
  }
  std::int64_t undefined = 0;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      undefined += IsInside(map.Sample({x, y}), map.width(), map.height()) ? 0 : 1;
    }
  }
  return static_cast<double>(undefined) / (static_cast<double>(map.width()) * map.height());
}

}  // namespace rsstab::stabilizer
