// SPDX-License-Identifier: Apache-2.0
#include "igf/base/motion_field.h"

#include <algorithm>
#include <cmath>

namespace rsstab {

MotionField::MotionField(int width, int height, int columns, int rows)
    : width_(width),
      height_(height),
      columns_(columns),
      rows_(rows),
      reference_row_((height - 1) / 2.0),
      displacement_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
                    Eigen::Vector2f::Zero()) {}

Eigen::Vector2d MotionField::VertexPosition(int column, int row) const {
  return {static_cast<double>(column) * (width_ - 1) / (columns_ - 1),
          static_cast<double>(row) * (height_ - 1) / (rows_ - 1)};
}

Eigen::Vector2d MotionField::Sample(const Eigen::Vector2d& pixel) const {
  // A one-pixel side has all its vertices on that pixel.
  const double gx = width_ > 1 ? pixel.x() * (columns_ - 1) / (width_ - 1) : 0.0;
  const double gy = height_ > 1 ? pixel.y() * (rows_ - 1) / (height_ - 1) : 0.0;
  const double cx = std::clamp(gx, 0.0, columns_ - 1.0);
  const double cy = std::clamp(gy, 0.0, rows_ - 1.0);
  const int c0 = std::min(static_cast<int>(cx), columns_ - 2);
  const int r0 = std::min(static_cast<int>(cy), rows_ - 2);
  const double fx = cx - c0;
  const double fy = cy - r0;
  const Eigen::Vector2d top =
      (1.0 - fx) * At(c0, r0).cast<double>() + fx * At(c0 + 1, r0).cast<double>();
  const Eigen::Vector2d bottom =
      (1.0 - fx) * At(c0, r0 + 1).cast<double>() + fx * At(c0 + 1, r0 + 1).cast<double>();
  return (1.0 - fy) * top + fy * bottom;
}

MotionField MotionField::Rescaled(int new_width, int new_height) const {
  MotionField result = *this;
  result.width_ = new_width;
  result.height_ = new_height;
  // Corner pixels stay corner pixels, so displacements scale like the distance between them.
  const double sx = width_ > 1 ? (new_width - 1.0) / (width_ - 1.0) : 1.0;
  const double sy = height_ > 1 ? (new_height - 1.0) / (height_ - 1.0) : 1.0;
  result.reference_row_ = reference_row_ * sy;
  const Eigen::Vector2f scale(static_cast<float>(sx), static_cast<float>(sy));
  for (Eigen::Vector2f& d : result.displacement_) {
    d = d.cwiseProduct(scale);
  }
  return result;
}

double MotionField::RmsLength() const {
  if (displacement_.empty()) {
    return 0.0;
  }
  double sum = 0.0;
  for (const Eigen::Vector2f& d : displacement_) {
    sum += static_cast<double>(d.squaredNorm());
  }
  return std::sqrt(sum / static_cast<double>(displacement_.size()));
}

double MotionField::MaxLength() const {
  double largest = 0.0;
  for (const Eigen::Vector2f& d : displacement_) {
    largest = std::max(largest, static_cast<double>(d.norm()));
  }
  return largest;
}

}  // namespace rsstab
