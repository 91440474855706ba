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
// not left to the network. `train/orientation_planes.py` is the same definition for training.
//
// Channels: 20 bins of dx/dy of edges nearer to the vertical, 12 of dy/dx of edges nearer to the
// horizontal (square root of the mean edge strength per pixel of the cell, kept to 8 bits as in
// training), 2 x 4 pixels of a small normalised grey picture, and the cell's x in image heights
// from the middle.
inline constexpr Shape kOrientationShape{41, 24, 16};

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
