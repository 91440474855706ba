// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_BASELINES_ROTATION_SPLINE_H_
#define RSSTAB_EVALUATION_BASELINES_ROTATION_SPLINE_H_

#include <string>

#include "evaluation/motion_method.h"

namespace rsstab::evaluation {

// Rotation spline from tracks with a known readout time and lens: E. Ringaby, P.-E. Forssen,
// "Efficient Video Rectification and Stabilisation for Cell-Phones", IJCV 96, 2012, section 3.
// Key rotations evenly spaced over two or three frames, joined by SLERP, minimise the symmetric
// distance of the tracks (eq. 6); the picture is then rectified to one row's view (eq. 9).
// Departures: a robust loss (Cauchy, 1 px) beside the tracker's own forward-backward check, and a
// weak pull of keys towards their neighbours' middle, for those that fall between two frames.
class RotationSplineMethod final : public MotionMethod {
 public:
  [[nodiscard]] std::string Name() const override { return "rotation-spline"; }
  // Errors: kUnsupported without a frame before or after, lens, readout time or frame interval;
  // kUntrustworthy with too few tracks.
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override;
};

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_BASELINES_ROTATION_SPLINE_H_
