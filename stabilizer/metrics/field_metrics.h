// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_FIELD_METRICS_H_
#define RSSTAB_STABILIZER_METRICS_FIELD_METRICS_H_

#include <Eigen/Core>
#include <span>

#include "igf/base/motion_field.h"
#include "igf/base/result.h"
#include "stabilizer/metrics/image_metrics.h"

namespace rsstab::stabilizer {

// End-point error: mean length of the difference of two displacement fields, px of the picture the
// fields are stated for. Any thread.

// The difference of two fields, by its parts: means over the pixels, px.
struct FieldError {
  double length = 0.0;        // end-point error
  double horizontal = 0.0;    // of |x|: the part that skew, twist and sideways wobble make
  double vertical = 0.0;      // of |y|
  double valid_pixels = 0.0;  // how many of them
};

// Dense fields, one displacement a pixel, row by row. `valid` as for PSNR.
// Errors: kInvalidArgument for different sizes or no valid pixel.
[[nodiscard]] Result<FieldError> CompareFields(std::span<const Eigen::Vector2f> estimate,
                                               std::span<const Eigen::Vector2f> truth,
                                               PixelMask valid = {});

// Its length alone. Errors as above.
[[nodiscard]] Result<double> EndPointError(std::span<const Eigen::Vector2f> estimate,
                                           std::span<const Eigen::Vector2f> truth,
                                           PixelMask valid = {});

// Vertex fields, compared at every pixel of truth's width x height (`valid` row by row at that
// size); the estimate is rescaled when it is stated for another size.
// Errors: kInvalidArgument for a mask of another size, no valid pixel, or different reference rows
// (they would differ by a shift that says nothing about the motion).
[[nodiscard]] Result<double> EndPointError(const MotionField& estimate, const MotionField& truth,
                                           PixelMask valid = {});

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_FIELD_METRICS_H_
