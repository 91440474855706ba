// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_BASELINES_STRAIGHT_LINES_H_
#define RSSTAB_EVALUATION_BASELINES_STRAIGHT_LINES_H_

#include <string>

#include "evaluation/motion_method.h"

namespace rsstab::evaluation {

// One picture's motion from the lines of a man-made scene, in the spirit of
//   V. Rengarajan, A. N. Rajagopalan, R. Aravind, "From Bows to Arrows: Rolling Shutter
//   Rectification of Urban Scenes", CVPR 2016: straight lines are straight again and lead to the
//   dominant directions, under a motion that is a low-order polynomial of the row (eqs. 7 to 10);
//   P. Purkait, C. Zach, A. Leonardis, "Rolling Shutter Correction in Manhattan World", ICCV 2017:
//   the rotation during the readout under which line segments meet three vanishing points at right
//   angles (eqs. 4 to 7).
// Departures: a full rotation of second order instead of one translation and roll (Rengarajan) or
// of first order (Purkait); curves come as chains of the segments that a detector finds (LSD);
// verticals need not be upright; robust least squares over all segments instead of minimal sets or
// annealed weights.
class StraightLinesMethod final : public MotionMethod {
 public:
  // `know_focal`: use the true focal length where the input tells it; otherwise one picture width.
  explicit StraightLinesMethod(bool know_focal) : know_focal_(know_focal) {}

  [[nodiscard]] std::string Name() const override { return "lines"; }
  // Errors: kUntrustworthy for a picture without enough such lines; kUnsupported for one without
  // 8-bit brightness.
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override;

 private:
  bool know_focal_;
};

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_BASELINES_STRAIGHT_LINES_H_
