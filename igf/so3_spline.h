// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SO3_SPLINE_H_
#define RSSTAB_IGF_SO3_SPLINE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "igf/base/rotation.h"

namespace rsstab::igf {

// [v]x: the matrix with CrossMatrix(v) w = v x w.
[[nodiscard]] inline Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

// Right Jacobian of SO(3): exp(v + e) = exp(v) exp(J_r(v) e) to first order in e. J_r(-v) is the
// left one.
[[nodiscard]] Eigen::Matrix3d RightJacobianSo3(const Eigen::Vector3d& v);
// Its inverse, for |v| < pi: log(exp(v) exp(e)) = v + J_r(v)^-1 e.
[[nodiscard]] Eigen::Matrix3d InverseRightJacobianSo3(const Eigen::Vector3d& v);

inline constexpr int kSplineOrder = 4;  // knots that rule one instant of a cubic spline

// The way from one knot to the next, and how it follows them. Computed once for each interval,
// whatever the number of instants looked at in it.
struct SplineStep {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // log(q_{k-1}^-1 q_k), rad
  // d turn / d e for knots q exp(e).
  Eigen::Matrix3d by_earlier = -Eigen::Matrix3d::Identity();
  Eigen::Matrix3d by_later = Eigen::Matrix3d::Identity();
};
[[nodiscard]] SplineStep MakeSplineStep(const Eigen::Quaterniond& earlier,
                                        const Eigen::Quaterniond& later);

// An instant of the spline.
struct SplinePoint {
  Eigen::Quaterniond world_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();  // body rate: q(t + dt) = q exp(rate dt)
  // e_q / e_k: how the orientation q exp(e_q) follows its knots q_k exp(e_k).
  std::array<Eigen::Matrix3d, kSplineOrder> by_knot;
};

// Cumulative cubic B-spline on SO(3) (Kim, Kim and Shin 1995; Jacobians as in Sommer et al. 2020):
//   q(u) = q_0 exp(l_1(u) W_1) exp(l_2(u) W_2) exp(l_3(u) W_3),  W_j = log(q_{j-1}^-1 q_j),
//   l_1 = (5 + 3u - 3u^2 + u^3) / 6,  l_2 = (1 + 3u + 3u^2 - 2u^3) / 6,  l_3 = u^3 / 6,
// with u in [0, 1) the place between the knots q_1 and q_2, `interval_s` apart. `steps` are those
// from q_0 to q_1, q_1 to q_2 and q_2 to q_3.
[[nodiscard]] SplinePoint EvaluateSplineWithJacobians(const Eigen::Quaterniond& first_knot,
                                                      const SplineStep* steps, double u,
                                                      double interval_s);

// Camera orientation over time with evenly spaced knots. Knot k stands for the time
// start_s + k interval_s, but the curve does not pass through it; it is defined over
// [start_s + interval_s, start_s + (knots - 2) interval_s). Const methods: any thread.
class So3Spline {
 public:
  // interval_s > 0.
  So3Spline(double start_s, double interval_s) : start_s_(start_s), interval_s_(interval_s) {}

  void Append(const Eigen::Quaterniond& world_from_camera) { knots_.push_back(world_from_camera); }

  [[nodiscard]] double interval_s() const { return interval_s_; }
  [[nodiscard]] double KnotTime(std::size_t k) const {
    return start_s_ + static_cast<double>(k) * interval_s_;
  }
  [[nodiscard]] const std::vector<Eigen::Quaterniond>& knots() const { return knots_; }

  // Half-open span in which the curve is defined; empty (begin >= end) with fewer than four knots.
  [[nodiscard]] double begin_s() const { return KnotTime(1); }
  [[nodiscard]] double end_s() const;

  // R(t): world directions to camera directions. Empty outside [begin_s, end_s).
  [[nodiscard]] std::optional<Eigen::Quaterniond> CameraFromWorld(double time_s) const;

 private:
  double start_s_;
  double interval_s_;
  std::vector<Eigen::Quaterniond> knots_;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SO3_SPLINE_H_
