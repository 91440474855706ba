// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_UPDATE_PARAMETERS_DETAIL_H_
#define RSSTAB_STABILIZER_UPDATE_PARAMETERS_DETAIL_H_

#include <ceres/rotation.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

namespace rsstab::stabilizer {

// The global update B(theta) of one frame, output -> rectified, with its eight degrees of freedom
// ordered by how willingly a camera gives them:
//   B = K exp([w]x) K^-1 A,   A = [e^s (1+a)  b  tx; b  e^s (1-a)  ty; 0 0 1],  K = diag(f, f, 1)
//   theta = (w_x, w_y, w_z, t_x, t_y, s, a, b)
// A turn (w) keeps the perspective right for a real camera; shift, zoom (s) and stretch (a, b) are
// what a turn cannot tell.
inline constexpr int kUpdateSize = 8;
inline constexpr std::size_t kZoomIndex = 5;  // s; negative = zoomed in
using UpdateParameters = std::array<double, kUpdateSize>;

// B(theta) as a matrix, its last element 1.
[[nodiscard]] Eigen::Matrix3d UpdateHomography(const UpdateParameters& theta, double focal_ratio);

template <typename T>
using Point2 = Eigen::Matrix<T, 2, 1>;

template <typename T>
[[nodiscard]] Point2<T> TurnPoint(const T* rotation, double focal_ratio, const Point2<T>& p) {
  const T ray[3] = {p.x() / focal_ratio, p.y() / focal_ratio, T(1.0)};
  T turned[3];
  ceres::AngleAxisRotatePoint(rotation, ray, turned);
  return {turned[0] / turned[2] * focal_ratio, turned[1] / turned[2] * focal_ratio};
}

// B(theta) q
template <typename T>
[[nodiscard]] Point2<T> ApplyUpdate(const T* theta, double focal_ratio, const Point2<T>& q) {
  using std::exp;
  const T zoom = exp(theta[5]);
  const Point2<T> p(zoom * (1.0 + theta[6]) * q.x() + theta[7] * q.y() + theta[3],
                    theta[7] * q.x() + zoom * (1.0 - theta[6]) * q.y() + theta[4]);
  return TurnPoint(theta, focal_ratio, p);
}

// B(theta)^-1 p
template <typename T>
[[nodiscard]] Point2<T> ApplyInverseUpdate(const T* theta, double focal_ratio, const Point2<T>& p) {
  using std::exp;
  const T back[3] = {-theta[0], -theta[1], -theta[2]};
  const Point2<T> turned = TurnPoint(back, focal_ratio, p);
  const T zoom = exp(theta[5]);
  const T m00 = zoom * (1.0 + theta[6]);
  const T m11 = zoom * (1.0 - theta[6]);
  const T determinant = m00 * m11 - theta[7] * theta[7];
  const T x = turned.x() - theta[3];
  const T y = turned.y() - theta[4];
  return {(m11 * x - theta[7] * y) / determinant, (m00 * y - theta[7] * x) / determinant};
}

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_UPDATE_PARAMETERS_DETAIL_H_
