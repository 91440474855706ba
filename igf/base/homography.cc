// SPDX-License-Identifier: Apache-2.0
#include "igf/base/homography.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace rsstab {
namespace {

constexpr double kMinDepth = 1e-9;
constexpr double kMinDeterminant = 1e-12;

// Pixels of one size -> pixels of another, centres at integers.
Eigen::Matrix3d ResizeMatrix(int from_width, int from_height, int to_width, int to_height) {
  const double sx = static_cast<double>(to_width) / from_width;
  const double sy = static_cast<double>(to_height) / from_height;
  Eigen::Matrix3d m;
  m << sx, 0.0, 0.5 * sx - 0.5, 0.0, sy, 0.5 * sy - 0.5, 0.0, 0.0, 1.0;
  return m;
}

}  // namespace

std::optional<Eigen::Vector2d> ProjectChecked(const Eigen::Matrix3d& target_from_source,
                                              const Eigen::Vector2d& point) {
  const Eigen::Vector3d mapped = target_from_source * point.homogeneous();
  if (!(mapped.z() > kMinDepth) || !mapped.allFinite()) {
    return std::nullopt;
  }
  return mapped.hnormalized();
}

std::optional<Eigen::Matrix3d> InvertChecked(const Eigen::Matrix3d& homography) {
  if (!homography.allFinite()) {
    return std::nullopt;
  }
  const double determinant = homography.determinant();
  if (!(determinant > kMinDeterminant)) {
    return std::nullopt;
  }
  const Eigen::Matrix3d inverse = homography.inverse();
  if (!inverse.allFinite() || std::abs(inverse(2, 2)) < kMinDepth) {
    return std::nullopt;
  }
  return inverse / inverse(2, 2);
}

std::optional<Eigen::Matrix3d> HomographyFromFourPoints(
    const std::array<Eigen::Vector2d, 4>& source, const std::array<Eigen::Vector2d, 4>& target) {
  Eigen::Matrix<double, 8, 8> a = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = source[i].x();
    const double y = source[i].y();
    const double u = target[i].x();
    const double v = target[i].y();
    const auto row = static_cast<Eigen::Index>(2 * i);
    a.row(row) << x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y;
    a.row(row + 1) << 0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y;
    b(row) = u;
    b(row + 1) = v;
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, 8, 8>> lu(a);
  if (!lu.isInvertible()) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 8, 1> h = lu.solve(b);
  Eigen::Matrix3d result;
  result << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1.0;
  if (!result.allFinite()) {
    return std::nullopt;
  }
  return result;
}

Eigen::Matrix3d RescaleHomography(const Eigen::Matrix3d& homography, int from_width,
                                  int from_height, int to_width, int to_height) {
  const Eigen::Matrix3d to_from_from = ResizeMatrix(from_width, from_height, to_width, to_height);
  const Eigen::Matrix3d scaled = to_from_from * homography * to_from_from.inverse();
  return scaled / scaled(2, 2);
}

double AffineAnisotropy(const Eigen::Matrix3d& homography) {
  const Eigen::Matrix2d affine = homography.topLeftCorner<2, 2>() / homography(2, 2);
  const Eigen::Vector2d singular_values = affine.jacobiSvd().singularValues();
  return singular_values(0) > 0.0 ? singular_values(1) / singular_values(0) : 0.0;
}

}  // namespace rsstab
