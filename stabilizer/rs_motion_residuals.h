// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_RS_MOTION_RESIDUALS_H_
#define RSSTAB_STABILIZER_RS_MOTION_RESIDUALS_H_

#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "stabilizer/spline_state_detail.h"
#include "stabilizer/track_cells.h"

namespace rsstab::stabilizer {

// What a camera that moves past a near scene adds to a pair of frames beyond its rotation: a plane
// seen from two places differs by an affine motion (its shift is the rotation's). In picture
// widths per picture width:
//   x' += zoom x + shear y,  y' += turn x + (zoom + stretch) y.
inline constexpr int kParallaxParameters = 4;  // zoom, shear, stretch, turn

// Row-timed track residual (design: pi(K R(t') R(t)^T K^-1 x) - x'), in standard deviations:
//   ( f pi(q(t')^-1 q(t) (x / f, 1)) + parallax(x) - x' ) / sigma,
// x in picture widths, f = focal length in picture widths, t and t' the exposure times of the two
// rows. Parameters: readout (s), log of the focal length (picture widths), parallax, then the
// deltas of `knots` of `state` (indices), which must hold all that rule the two instants (instants
// beyond the spline are answered by the nearest segment).
class RowTimedTrackCost final : public ceres::CostFunction {
 public:
  RowTimedTrackCost(const SplineState& state, double from_time_s, double to_time_s,
                    const TrackCell& cell, double sigma, std::vector<std::size_t> knots);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const SplineState* state_;
  double from_time_s_;
  double to_time_s_;
  TrackCell cell_;
  double sigma_;
  std::vector<std::size_t> knots_;
};

// Weak smoothness: the change of the angular acceleration, as the second difference of the steps
// between four knots, times `weight` (1/rad). Parameters: the four deltas from `first_knot` on.
class JerkCost final : public ceres::SizedCostFunction<3, 3, 3, 3, 3> {
 public:
  JerkCost(const SplineState& state, std::size_t first_knot, double weight)
      : state_(&state), first_knot_(first_knot), weight_(weight) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const SplineState* state_;
  std::size_t first_knot_;
  double weight_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_RS_MOTION_RESIDUALS_H_
