// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_BASELINES_MANHATTAN_RESIDUALS_H_
#define RSSTAB_EVALUATION_BASELINES_MANHATTAN_RESIDUALS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "igf/base/rotation.h"

namespace rsstab::evaluation {

// A point of an edge as it was recorded: its ray K^-1 p and its time in the readout, s from -0.5
// (first row) to 0.5 (last row).
struct EdgePoint {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  double s = 0.0;
};

// Where the point belongs in the view of the middle row, on the plane z = 1:
//   R(s)^T K^-1 p,  R(s) = exp([rate s + change s^2]x)
// `motion`: rate (3), change (3), rad.
template <typename T>
[[nodiscard]] Eigen::Matrix<T, 2, 1> StraightenPoint(const EdgePoint& point, const T* motion) {
  const T s(point.s);
  const Eigen::Matrix<T, 3, 1> w(s * (motion[0] + s * motion[3]), s * (motion[1] + s * motion[4]),
                                 s * (motion[2] + s * motion[5]));
  const Eigen::Matrix<T, 3, 1> straight =
      ExpSo3<T>(Eigen::Matrix<T, 3, 1>(-w)) * point.ray.cast<T>();
  return straight.template head<2>() / straight.z();
}

// Sine of the angle, in the straightened picture, between a segment and the line from its middle to
// a vanishing point. An angle, since a motion that shrinks the picture makes every distance small.
// `direction`: of the vanishing point.
template <typename T>
[[nodiscard]] T OffVanishingLine(const EdgePoint& a, const EdgePoint& b, const T* motion,
                                 const Eigen::Matrix<T, 3, 1>& direction) {
  using std::sqrt;
  const Eigen::Matrix<T, 2, 1> end = StraightenPoint(a, motion);
  const Eigen::Matrix<T, 2, 1> middle = (end + StraightenPoint(b, motion)) * T(0.5);
  // Line through (middle, 1) and the vanishing point.
  const Eigen::Matrix<T, 3, 1> line =
      Eigen::Matrix<T, 3, 1>(middle.x(), middle.y(), T(1.0)).cross(direction);
  const T slope = sqrt(line.x() * line.x() + line.y() * line.y() + T(1e-12));
  const T half = sqrt((end - middle).squaredNorm() + T(1e-12));
  return (line.x() * end.x() + line.y() * end.y() + line.z()) / (slope * half);
}

// A segment that belongs to axis `axis` of a Manhattan frame: how far its ends are off for being
// turned, px of the recorded picture. Parameters: the motion (6), the frame's axes as a quaternion
// (camera_from_manhattan, x y z w).
class ManhattanResidual {
 public:
  ManhattanResidual(const EdgePoint& a, const EdgePoint& b, int axis, double half_length_px)
      : a_(a), b_(b), axis_(axis), half_length_px_(half_length_px) {}

  template <typename T>
  bool operator()(const T* motion, const T* axes, T* residual_px) const {
    const Eigen::Map<const Eigen::Quaternion<T>> camera_from_manhattan(axes);
    const Eigen::Matrix<T, 3, 1> direction =
        camera_from_manhattan * Eigen::Matrix<T, 3, 1>(T(axis_ == 0), T(axis_ == 1), T(axis_ == 2));
    residual_px[0] = T(half_length_px_) * OffVanishingLine(a_, b_, motion, direction);
    return true;
  }

 private:
  EdgePoint a_;
  EdgePoint b_;
  int axis_;
  double half_length_px_;
};

// Two pieces of one edge that a motion bent: where they meet lies on the line through their far
// ends, px (as if that line were as long as it was recorded). Parameter: the motion (6).
class StraightnessResidual {
 public:
  StraightnessResidual(const EdgePoint& a, const EdgePoint& b, const EdgePoint& c,
                       const EdgePoint& d, double length_px)
      : a_(a), b_(b), c_(c), d_(d), length_px_(length_px) {}

  template <typename T>
  bool operator()(const T* motion, T* residual_px) const {
    const Eigen::Matrix<T, 2, 1> a = StraightenPoint(a_, motion);
    const Eigen::Matrix<T, 2, 1> along = StraightenPoint(d_, motion) - a;
    const T squared_length = along.squaredNorm() + T(1e-12);
    const auto off = [&](const EdgePoint& point) {
      const Eigen::Matrix<T, 2, 1> across = StraightenPoint(point, motion) - a;
      return T(length_px_) * (along.x() * across.y() - along.y() * across.x()) / squared_length;
    };
    residual_px[0] = off(b_);
    residual_px[1] = off(c_);
    return true;
  }

 private:
  EdgePoint a_;
  EdgePoint b_;
  EdgePoint c_;
  EdgePoint d_;
  double length_px_;
};

// Keeps what the edges do not tell at zero. Parameter: the motion (6).
struct SmallMotionResidual {
  double rate_weight;
  double change_weight;

  template <typename T>
  bool operator()(const T* motion, T* residual) const {
    for (int i = 0; i < 3; ++i) {
      residual[i] = rate_weight * motion[i];
      residual[i + 3] = change_weight * motion[i + 3];
    }
    return true;
  }
};

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_BASELINES_MANHATTAN_RESIDUALS_H_
