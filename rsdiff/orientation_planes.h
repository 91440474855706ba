// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_ORIENTATION_PLANES_H_
#define RSSTAB_RSDIFF_ORIENTATION_PLANES_H_

#include <cstdint>
#include <span>

#include "igf/base/result.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

// The compact network's view of a picture: how edges lean, cell by cell. Rolling shutter shows in
// the direction of lines, so their directions are measured here (double-angle structure tensor) and
// not left to the network. `orientation_planes` and `condition_tensor` in train/ are
// the same definition for training.
//
// Channels:
//   0..31   edge strength by direction: 20 bins of dx/dy of edges nearer to the vertical, 12 of
//   dy/dx
//           of edges nearer to the horizontal; square root of the mean per pixel of the cell, in
//           steps of 1/32, as training stores them
//   32..63  the same as shares: square root of (strength squared / its sum over the cell's upright
//   or
//           level bins), less where there is little of either
//   64..71  2 x 4 pixels per cell of a small grey picture, mean 0, deviation about 1
//   72      the cell's x in image heights from the middle
inline constexpr Shape kOrientationShape{73, 24, 16};

struct PictureSize {
  int width = 0;
  int height = 0;
};

// Size at which the directions of a width x height picture are measured: about 384x288 pixels in
// area, same aspect, at least 64x48.
[[nodiscard]] PictureSize OrientationWorkingSize(int width, int height);

// `gray`: a picture of working size, full range, rows packed. Batch 1, kOrientationShape.
// Errors: kInvalidArgument for a picture below 64x48 or of another size than stated.
[[nodiscard]] Result<Tensor> OrientationPlanes(std::span<const std::uint8_t> gray,
                                               const PictureSize& size);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_ORIENTATION_PLANES_H_
