// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_DENSE_FIELD_H_
#define RSSTAB_RSDIFF_DENSE_FIELD_H_

#include <span>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/readout_motion.h"
#include "igf/base/result.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

// The published network works on dense fields of rows x columns (64x64) pixels: displacements
// divided by columns - 1 and rows - 1, in [-1, 1]. That small picture is the big one shrunk, so its
// pixel i is at x = (i + 0.5) W / columns - 0.5 of the big one, and displacements grow by W /
// columns: NOT the "aligned corners" of MotionField, whose vertices are resampled from it
// (bilinear, straight on over the half pixel beyond the outer centres).

// State (2 x rows x columns: all x, then all y displacements, in network units) -> field of an
// image of width x height. `reference_row` in the pixels of that image: the row on which the
// network's fields are zero (RS-Real: the first row, 0); the result states it, see
// WithMiddleReference. Errors: kInvalidArgument for a shape below 2 x 2 x 2, a state of another
// size, numbers that are not finite, an empty image or a grid below 2x2.
[[nodiscard]] Result<MotionField> FieldFromDenseState(std::span<const float> state,
                                                      const Shape& shape, int width, int height,
                                                      double reference_row,
                                                      const FieldGrid& grid = {});

// The inverse: samples the field at the small picture's pixels.
[[nodiscard]] std::vector<float> DenseStateFromField(const MotionField& field, const Shape& shape);

// Restates a field for the middle row as its reference. Between the two reference instants the
// camera turned by some R, so x_ref = K R^-1 K^-1 x_middle and G_middle(x) = x_ref + G(x_ref) - x.
// R is fitted (least squares) to what the field says of the middle row, which that row's own
// instant must leave in place.
// Errors: kInvalidArgument for a camera that is invalid or of another size.
[[nodiscard]] Result<MotionField> WithMiddleReference(const MotionField& field,
                                                      const Camera& camera);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_DENSE_FIELD_H_
