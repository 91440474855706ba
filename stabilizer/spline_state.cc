// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "igf/base/rotation.h"
#include "stabilizer/spline_state_detail.h"

namespace rsstab::stabilizer {

SplineState::SplineState(double start_s, double interval_s, std::vector<Eigen::Quaterniond> knots)
    : start_s_(start_s),
      interval_s_(interval_s),
      start_(std::move(knots)),
      delta_(start_.size(), Eigen::Vector3d::Zero()),
      knots_(start_),
      steps_(start_.size() - 1),
      by_delta_(start_.size(), Eigen::Matrix3d::Identity()) {
  PrepareForEvaluation(true, true);
}

void SplineState::PrepareForEvaluation(bool /*evaluate_jacobians*/, bool new_evaluation_point) {
  if (!new_evaluation_point) {
    return;
  }
  for (std::size_t k = 0; k < start_.size(); ++k) {
    knots_[k] = start_[k] * ExpSo3(delta_[k]);
    by_delta_[k] = igf::RightJacobianSo3(delta_[k]);
  }
  for (std::size_t k = 0; k + 1 < knots_.size(); ++k) {
    steps_[k] = igf::MakeSplineStep(knots_[k], knots_[k + 1]);
  }
}

std::ptrdiff_t SplineState::FirstKnotAt(double time_s) const {
  return static_cast<std::ptrdiff_t>(std::floor((time_s - start_s_) / interval_s_)) - 1;
}

SplineState::Instant SplineState::At(double time_s) const {
  const std::ptrdiff_t last_segment =
      static_cast<std::ptrdiff_t>(knots_.size()) - igf::kSplineOrder;
  Instant instant;
  instant.first_knot =
      static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(FirstKnotAt(time_s), 0, last_segment));
  const double u =
      (time_s - start_s_) / interval_s_ - static_cast<double>(instant.first_knot) - 1.0;
  instant.point = igf::EvaluateSplineWithJacobians(knots_[instant.first_knot],
                                                   &steps_[instant.first_knot], u, interval_s_);
  return instant;
}

}  // namespace rsstab::stabilizer
