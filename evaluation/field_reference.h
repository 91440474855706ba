// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_FIELD_REFERENCE_H_
#define RSSTAB_EVALUATION_FIELD_REFERENCE_H_

#include <Eigen/Geometry>
#include <span>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/readout_motion.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// A field refers to the view of one row's instant, here usually the middle one, in RS-Real the
// first. Fields must be brought to one row before they are compared. Any thread.

// Rows closer than this are one row, px.
inline constexpr double kSameRow = 1e-6;

// The field of a turning camera, told from the view at `reference_row`. `camera_row_from_any`:
// unit quaternions at evenly spaced rows from 0 to height - 1, at least 2, all relative to one
// orientation, whichever.
// Errors: those of ReadoutMotion::Create.
[[nodiscard]] Result<MotionField> FieldFromRow(
    const Camera& camera, std::span<const Eigen::Quaterniond> camera_row_from_any,
    double reference_row, const FieldGrid& grid = {});

// The same motion told from another row, of a field of which nothing else is known: what the field
// does to that row is taken for a rotation (least squares over the row's pixels, perspective by
// `camera`), since the change of view must be one.
// Errors: kInvalidArgument for a camera of another size.
[[nodiscard]] Result<MotionField> WithReferenceRow(const MotionField& field, const Camera& camera,
                                                   double reference_row);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_FIELD_REFERENCE_H_
