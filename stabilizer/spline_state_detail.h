// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_SPLINE_STATE_DETAIL_H_
#define RSSTAB_STABILIZER_SPLINE_STATE_DETAIL_H_

#include <ceres/evaluation_callback.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "igf/so3_spline.h"

namespace rsstab::stabilizer {

// The knots of a rotation spline while Ceres moves them: knot k is start_k exp(delta_k), and
// delta_k is the parameter block. What all residuals need of the knots is computed once for each
// evaluation, before them.
class SplineState final : public ceres::EvaluationCallback {
 public:
  // `knots`: world_from_camera, at least four; knot k stands for start_s + k interval_s.
  SplineState(double start_s, double interval_s, std::vector<Eigen::Quaterniond> knots);

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

  [[nodiscard]] std::size_t size() const { return start_.size(); }
  [[nodiscard]] double* Delta(std::size_t k) { return delta_[k].data(); }
  [[nodiscard]] const igf::SplineStep& StepFrom(std::size_t k) const { return steps_[k]; }
  // d e_k / d delta_k for a knot q exp(e_k).
  [[nodiscard]] const Eigen::Matrix3d& ByDelta(std::size_t k) const { return by_delta_[k]; }
  [[nodiscard]] const std::vector<Eigen::Quaterniond>& knots() const { return knots_; }

  // First of the four knots that rule an instant (not limited to the knots there are).
  [[nodiscard]] std::ptrdiff_t FirstKnotAt(double time_s) const;

  struct Instant {
    std::size_t first_knot = 0;
    igf::SplinePoint point;
  };
  // An instant outside the spline is answered by the nearest segment's polynomial.
  [[nodiscard]] Instant At(double time_s) const;

 private:
  double start_s_;
  double interval_s_;
  std::vector<Eigen::Quaterniond> start_;
  std::vector<Eigen::Vector3d> delta_;
  std::vector<Eigen::Quaterniond> knots_;
  std::vector<igf::SplineStep> steps_;
  std::vector<Eigen::Matrix3d> by_delta_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_SPLINE_STATE_DETAIL_H_
