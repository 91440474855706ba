// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/rs_motion_residuals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rsstab::stabilizer {
namespace {

using RowMajor23 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

constexpr int kReadoutBlock = 0;
constexpr int kFocalBlock = 1;
constexpr int kParallaxBlock = 2;
constexpr int kFirstKnotBlock = 3;
constexpr double kMinDepth = 1e-2;

}  // namespace

RowTimedTrackCost::RowTimedTrackCost(const SplineState& state, double from_time_s, double to_time_s,
                                     const TrackCell& cell, double sigma,
                                     std::vector<std::size_t> knots)
    : state_(&state),
      from_time_s_(from_time_s),
      to_time_s_(to_time_s),
      cell_(cell),
      sigma_(sigma),
      knots_(std::move(knots)) {
  set_num_residuals(2);
  mutable_parameter_block_sizes()->assign({1, 1, kParallaxParameters});
  mutable_parameter_block_sizes()->insert(mutable_parameter_block_sizes()->end(), knots_.size(), 3);
}

bool RowTimedTrackCost::Evaluate(double const* const* parameters, double* residuals,
                                 double** jacobians) const {
  const double readout_s = parameters[kReadoutBlock][0];
  const double focal = std::exp(parameters[kFocalBlock][0]);
  const Eigen::Map<const Eigen::Vector4d> parallax(parameters[kParallaxBlock]);
  const SplineState::Instant from = state_->At(from_time_s_ + readout_s * cell_.from_row_share);
  const SplineState::Instant to = state_->At(to_time_s_ + readout_s * cell_.to_row_share);

  const Eigen::Matrix3d to_from =
      (to.point.world_from_camera.conjugate() * from.point.world_from_camera).toRotationMatrix();
  const Eigen::Vector3d ray(cell_.from.x() / focal, cell_.from.y() / focal, 1.0);
  const Eigen::Vector3d seen = to_from * ray;
  if (!(seen.z() > kMinDepth)) {
    return false;
  }
  const Eigen::Vector2d projected = focal * seen.hnormalized();
  const double x = cell_.from.x();
  const double y = cell_.from.y();
  const Eigen::Vector2d drift(parallax[0] * x + parallax[1] * y,
                              parallax[3] * x + (parallax[0] + parallax[2]) * y);
  Eigen::Map<Eigen::Vector2d>(residuals, 2) = (projected + drift - cell_.to) / sigma_;
  if (jacobians == nullptr) {
    return true;
  }

  RowMajor23 by_seen;
  by_seen << 1.0, 0.0, -seen.x() / seen.z(), 0.0, 1.0, -seen.y() / seen.z();
  by_seen *= focal / (seen.z() * sigma_);
  // q exp(e) at the earlier instant turns the ray, at the later one what is seen of it.
  const RowMajor23 by_from = -by_seen * to_from * igf::CrossMatrix(ray);
  const RowMajor23 by_to = by_seen * igf::CrossMatrix(seen);
  if (double* j = jacobians[kReadoutBlock]; j != nullptr) {
    Eigen::Map<Eigen::Vector2d>(j, 2) = by_from * from.point.rate_rad_s * cell_.from_row_share +
                                        by_to * to.point.rate_rad_s * cell_.to_row_share;
  }
  if (double* j = jacobians[kFocalBlock]; j != nullptr) {
    Eigen::Map<Eigen::Vector2d>(j, 2) =
        projected / sigma_ + by_seen * to_from * Eigen::Vector3d(-ray.x(), -ray.y(), 0.0);
  }
  if (double* j = jacobians[kParallaxBlock]; j != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, kParallaxParameters, Eigen::RowMajor>> block(j);
    block << x, y, 0.0, 0.0, y, 0.0, y, x;
    block /= sigma_;
  }
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    double* j = jacobians[kFirstKnotBlock + static_cast<int>(i)];
    if (j == nullptr) {
      continue;
    }
    const std::size_t knot = knots_[i];
    RowMajor23 block = RowMajor23::Zero();
    if (knot >= from.first_knot && knot < from.first_knot + igf::kSplineOrder) {
      block += by_from * from.point.by_knot[knot - from.first_knot];
    }
    if (knot >= to.first_knot && knot < to.first_knot + igf::kSplineOrder) {
      block += by_to * to.point.by_knot[knot - to.first_knot];
    }
    Eigen::Map<RowMajor23>(j, 2, 3) = block * state_->ByDelta(knot);
  }
  return true;
}

bool JerkCost::Evaluate(double const* const* /*parameters*/, double* residuals,
                        double** jacobians) const {
  constexpr std::array<double, 3> kDifference = {1.0, -2.0, 1.0};
  Eigen::Map<Eigen::Vector3d> residual(residuals, 3);
  residual.setZero();
  for (std::size_t j = 0; j < 3; ++j) {
    residual += weight_ * kDifference[j] * state_->StepFrom(first_knot_ + j).turn;
  }
  if (jacobians == nullptr) {
    return true;
  }
  for (std::size_t k = 0; k < igf::kSplineOrder; ++k) {
    if (jacobians[k] == nullptr) {
      continue;
    }
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    if (k < 3) {
      block += kDifference[k] * state_->StepFrom(first_knot_ + k).by_earlier;
    }
    if (k > 0) {
      block += kDifference[k - 1] * state_->StepFrom(first_knot_ + k - 1).by_later;
    }
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(jacobians[k], 3, 3) =
        weight_ * block * state_->ByDelta(first_knot_ + k);
  }
  return true;
}

}  // namespace rsstab::stabilizer
