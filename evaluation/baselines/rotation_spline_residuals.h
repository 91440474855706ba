// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_BASELINES_ROTATION_SPLINE_RESIDUALS_H_
#define RSSTAB_EVALUATION_BASELINES_ROTATION_SPLINE_RESIDUALS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "igf/base/rotation.h"

namespace rsstab::evaluation {

// SLERP between two key rotations, given as rotation vectors; `share` in [0, 1].
template <typename T>
[[nodiscard]] Eigen::Quaternion<T> BetweenKeys(const T* first, const T* second, double share) {
  const Eigen::Map<const Eigen::Matrix<T, 3, 1>> a(first);
  const Eigen::Map<const Eigen::Matrix<T, 3, 1>> b(second);
  const Eigen::Quaternion<T> from = ExpSo3<T>(a);
  const Eigen::Matrix<T, 3, 1> step = LogSo3<T>(from.conjugate() * ExpSo3<T>(b));
  return from * ExpSo3<T>(step * T(share));
}

// Ringaby & Forssen 2012, eq. 6: distance between a point and where the rotation between the two
// exposures takes its match, in both directions, px:
//   x' - pi(K R(t') R(t)^T K^-1 x)  and  x - pi(K R(t) R(t')^T K^-1 x')
// Parameters: the key rotations before and after t, then those before and after t', as rotation
// vectors (camera_from_world).
class SplineTrackResidual {
 public:
  // `from_ray`, `to_ray`: K^-1 x; `focal_px` turns plane distances into px.
  SplineTrackResidual(const Eigen::Vector3d& from_ray, double from_share,
                      const Eigen::Vector3d& to_ray, double to_share, double focal_px)
      : from_ray_(from_ray),
        to_ray_(to_ray),
        from_share_(from_share),
        to_share_(to_share),
        focal_px_(focal_px) {}

  template <typename T>
  bool operator()(const T* from_a, const T* from_b, const T* to_a, const T* to_b,
                  T* residual_px) const {
    const Eigen::Quaternion<T> from = BetweenKeys(from_a, from_b, from_share_);
    const Eigen::Quaternion<T> to = BetweenKeys(to_a, to_b, to_share_);
    const Eigen::Quaternion<T> to_from_from = to * from.conjugate();
    const Eigen::Matrix<T, 3, 1> there = to_from_from * from_ray_.cast<T>();
    const Eigen::Matrix<T, 3, 1> back = to_from_from.conjugate() * to_ray_.cast<T>();
    if (!(there.z() > T(0.01)) || !(back.z() > T(0.01))) {
      return false;
    }
    residual_px[0] = focal_px_ * (there.x() / there.z() - to_ray_.x());
    residual_px[1] = focal_px_ * (there.y() / there.z() - to_ray_.y());
    residual_px[2] = focal_px_ * (back.x() / back.z() - from_ray_.x());
    residual_px[3] = focal_px_ * (back.y() / back.z() - from_ray_.y());
    return true;
  }

 private:
  Eigen::Vector3d from_ray_;
  Eigen::Vector3d to_ray_;
  double from_share_;
  double to_share_;
  double focal_px_;
};

// Keeps keys that no track sees (between frames) on the way between their neighbours.
struct SplineBendResidual {
  double weight;

  template <typename T>
  bool operator()(const T* before, const T* key, const T* after, T* residual) const {
    for (int i = 0; i < 3; ++i) {
      residual[i] = weight * (before[i] - T(2.0) * key[i] + after[i]);
    }
    return true;
  }
};

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_BASELINES_ROTATION_SPLINE_RESIDUALS_H_
