// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_ROTATION_CURVE_H_
#define RSSTAB_RSDIFF_ROTATION_CURVE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/readout_motion.h"
#include "igf/base/result.h"

namespace rsstab::rsdiff {

// How a camera turned while one frame was read out, told at B equal row bands from top to bottom.
// The centre of band b lies at row (b + 0.5) / B * H - 0.5. Each entry is (a, b, r):
//   a, b  displacement G of the image centre, in image heights: x to the right, y down;
//   r     roll, rad.
// They stand for the rotation camera_row_from_reference = exp([w]x) with
//   w = (-b H / fy, a H / fx, r),
// so an RS pixel lies at p = K exp([w]x) K^-1 x, and G = p - x. The reference is the middle row.
using RotationCurve = std::vector<Eigen::Vector3d>;

// The curve's value at a row of an image of `height` rows, without the subtraction below. Between
// band centres: cubic Hermite per component, tangents half the difference of the neighbours
// (Catmull-Rom), one-sided at the first and last band; beyond the outer centres straight on along
// the end tangent. One band is a constant. The curve has at least one band.
[[nodiscard]] Eigen::Vector3d CurveAtRow(const RotationCurve& curve, double row, int height);

// camera_row_from_reference at `count` >= 2 evenly spaced rows from 0 to height - 1. The curve's
// value at the middle row (height - 1) / 2 is subtracted first, so that G = 0 there.
[[nodiscard]] std::vector<Eigen::Quaterniond> RowRotationsFromCurve(const RotationCurve& curve,
                                                                    const Camera& camera,
                                                                    int count);

// Inverse of the above at the band centres. `camera_row_from_reference(row)` is asked for rows
// inside the image, reference the middle row.
[[nodiscard]] RotationCurve CurveFromRowRotations(
    const std::function<Eigen::Quaterniond(double row)>& camera_row_from_reference,
    const Camera& camera, int bands);

// The motion field of a curve, by the exact fixed point; reference row the middle.
// Errors: kInvalidArgument for a curve without bands or with numbers that are not finite, an
// invalid camera or grid.
[[nodiscard]] Result<MotionField> FieldFromCurve(const RotationCurve& curve, const Camera& camera,
                                                 const FieldGrid& grid = {});

// Network units (3 x bands, channel by channel: all a, all b, all r) times `scale` per channel, and
// back. `state` has 3 * bands values.
[[nodiscard]] RotationCurve CurveFromState(std::span<const float> state,
                                           const Eigen::Vector3d& scale);
[[nodiscard]] std::vector<float> StateFromCurve(const RotationCurve& curve,
                                                const Eigen::Vector3d& scale);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_ROTATION_CURVE_H_
