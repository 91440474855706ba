// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_ROTATION_H_
#define RSSTAB_IGF_BASE_ROTATION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace rsstab {

// Below this squared angle the series is exact to double precision.
inline constexpr double kSmallAngleSquared = 1e-8;

// Exponential map of SO(3): rotation vector (rad, right-hand rule) -> unit quaternion.
// Templated for automatic differentiation; smooth through zero.
template <typename T>
[[nodiscard]] Eigen::Quaternion<T> ExpSo3(const Eigen::Matrix<T, 3, 1>& rotation_vector) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T angle_sq = rotation_vector.squaredNorm();
  T real;
  T scale;
  if (angle_sq < kSmallAngleSquared) {
    // sin(a/2)/a and cos(a/2) by their series in a^2.
    real = T(1.0) - angle_sq / 8.0;
    scale = T(0.5) - angle_sq / 48.0;
  } else {
    const T angle = sqrt(angle_sq);
    real = cos(angle * 0.5);
    scale = sin(angle * 0.5) / angle;
  }
  return Eigen::Quaternion<T>(real, scale * rotation_vector.x(), scale * rotation_vector.y(),
                              scale * rotation_vector.z());
}

// Inverse of ExpSo3: unit quaternion -> rotation vector of angle in [0, pi] (q and -q agree).
template <typename T>
[[nodiscard]] Eigen::Matrix<T, 3, 1> LogSo3(const Eigen::Quaternion<T>& q) {
  using std::atan2;
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> v = q.vec();
  const T sin_sq = v.squaredNorm();
  if (sin_sq < kSmallAngleSquared) {
    const T sign = q.w() < T(0.0) ? T(-1.0) : T(1.0);
    return (T(2.0) * sign + sign * sin_sq / 3.0) * v;
  }
  const T sin_half = sqrt(sin_sq);
  const T half = q.w() < T(0.0) ? atan2(-sin_half, -q.w()) : atan2(sin_half, q.w());
  return (T(2.0) * half / sin_half) * v;
}

// H_{a<-b} = K R(t_a) R(t_b)^T K^-1: takes a pixel seen at time b to where the same world direction
// is seen at time a. Rotations are camera_from_world; K in pixels, centres at integers.
[[nodiscard]] inline Eigen::Matrix3d RotationHomography(
    const Eigen::Matrix3d& k, const Eigen::Quaterniond& camera_from_world_a,
    const Eigen::Quaterniond& camera_from_world_b) {
  const Eigen::Matrix3d a_from_b =
      (camera_from_world_a * camera_from_world_b.conjugate()).toRotationMatrix();
  return k * a_from_b * k.inverse();
}

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_ROTATION_H_
