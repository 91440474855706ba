// SPDX-License-Identifier: Apache-2.0
#include "igf/so3_spline.h"

#include <cmath>

namespace rsstab::igf {
namespace {

struct CumulativeBasis {
  std::array<double, 3> value;
  std::array<double, 3> slope;  // by u
};

CumulativeBasis BasisAt(double u) {
  const double u2 = u * u;
  return {{(5.0 + 3.0 * u - 3.0 * u2 + u2 * u) / 6.0,
           (1.0 + 3.0 * u + 3.0 * u2 - 2.0 * u2 * u) / 6.0, u2 * u / 6.0},
          {(1.0 - 2.0 * u + u2) / 2.0, (1.0 + 2.0 * u - 2.0 * u2) / 2.0, u2 / 2.0}};
}

}  // namespace

Eigen::Matrix3d RightJacobianSo3(const Eigen::Vector3d& v) {
  const double angle_sq = v.squaredNorm();
  double a;  // (1 - cos) / angle^2
  double b;  // (angle - sin) / angle^3
  if (angle_sq < kSmallAngleSquared) {
    a = 0.5 - angle_sq / 24.0;
    b = 1.0 / 6.0 - angle_sq / 120.0;
  } else {
    const double angle = std::sqrt(angle_sq);
    a = (1.0 - std::cos(angle)) / angle_sq;
    b = (angle - std::sin(angle)) / (angle_sq * angle);
  }
  const Eigen::Matrix3d cross = CrossMatrix(v);
  return Eigen::Matrix3d::Identity() - a * cross + b * cross * cross;
}

Eigen::Matrix3d InverseRightJacobianSo3(const Eigen::Vector3d& v) {
  const double angle_sq = v.squaredNorm();
  double c;  // 1 / angle^2 - (1 + cos) / (2 angle sin)
  if (angle_sq < kSmallAngleSquared) {
    c = 1.0 / 12.0 + angle_sq / 720.0;
  } else {
    const double angle = std::sqrt(angle_sq);
    c = 1.0 / angle_sq - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  }
  const Eigen::Matrix3d cross = CrossMatrix(v);
  return Eigen::Matrix3d::Identity() + 0.5 * cross + c * cross * cross;
}

SplineStep MakeSplineStep(const Eigen::Quaterniond& earlier, const Eigen::Quaterniond& later) {
  SplineStep step;
  step.turn = LogSo3(Eigen::Quaterniond(earlier.conjugate() * later));
  step.by_later = InverseRightJacobianSo3(step.turn);
  step.by_earlier = -InverseRightJacobianSo3(-step.turn);
  return step;
}

SplinePoint EvaluateSplineWithJacobians(const Eigen::Quaterniond& first_knot,
                                        const SplineStep* steps, double u, double interval_s) {
  const CumulativeBasis basis = BasisAt(u);
  std::array<Eigen::Quaterniond, 3> turns;
  for (std::size_t j = 0; j < 3; ++j) {
    turns[j] = ExpSo3(Eigen::Vector3d(basis.value[j] * steps[j].turn));
  }
  SplinePoint point;
  // Body rate: each later turn carries the rates of the earlier ones into its own frame.
  for (std::size_t j = 0; j < 3; ++j) {
    point.rate_rad_s =
        turns[j].conjugate() * point.rate_rad_s + basis.slope[j] / interval_s * steps[j].turn;
  }
  // A change of turn j is seen through the turns after it.
  for (Eigen::Matrix3d& block : point.by_knot) {
    block.setZero();
  }
  Eigen::Matrix3d end_from_turn = Eigen::Matrix3d::Identity();
  for (std::size_t j = 3; j-- > 0;) {
    const Eigen::Matrix3d by_turn =
        end_from_turn * RightJacobianSo3(basis.value[j] * steps[j].turn) * basis.value[j];
    point.by_knot[j] += by_turn * steps[j].by_earlier;
    point.by_knot[j + 1] += by_turn * steps[j].by_later;
    end_from_turn = end_from_turn * turns[j].conjugate().toRotationMatrix();
  }
  point.by_knot[0] += end_from_turn;
  point.world_from_camera = first_knot * turns[0] * turns[1] * turns[2];
  return point;
}

double So3Spline::end_s() const {
  return knots_.size() < kSplineOrder ? begin_s() : KnotTime(knots_.size() - 2);
}

std::optional<Eigen::Quaterniond> So3Spline::CameraFromWorld(double time_s) const {
  if (!(time_s >= begin_s()) || !(time_s < end_s())) {
    return std::nullopt;
  }
  const double place = (time_s - start_s_) / interval_s_;
  // Rounding may put an instant at the very end into the interval after it.
  const auto middle =
      std::clamp<std::size_t>(static_cast<std::size_t>(place), 1, knots_.size() - 3);
  const std::size_t first = middle - 1;
  const CumulativeBasis basis = BasisAt(place - static_cast<double>(middle));
  Eigen::Quaterniond world_from_camera = knots_[first];
  for (std::size_t j = 0; j < 3; ++j) {
    const Eigen::Vector3d turn =
        LogSo3(Eigen::Quaterniond(knots_[first + j].conjugate() * knots_[first + j + 1]));
    world_from_camera = world_from_camera * ExpSo3(Eigen::Vector3d(basis.value[j] * turn));
  }
  return world_from_camera.normalized().conjugate();
}

}  // namespace rsstab::igf
