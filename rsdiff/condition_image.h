// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_CONDITION_IMAGE_H_
#define RSSTAB_RSDIFF_CONDITION_IMAGE_H_

#include "igf/base/frame.h"
#include "igf/base/result.h"
#include "rsdiff/model_file.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

// Picture -> network input, batch 1. Any layout of FrameView, 8 to 16 bits, any size and aspect:
// the whole picture is stretched over the input's rows and columns. YUV is read as BT.709 above 576
// rows and BT.601 below; limited range is expanded.
//   kRgb                red, green, blue in [-1, 1]; shrunk by area averages, enlarged bilinearly
//   kOrientationPlanes  see orientation_planes.h
// Errors: kInvalidArgument for a picture without samples or a shape that the kind does not have;
// kUnsupported for a layout that no converter knows.
[[nodiscard]] Result<Tensor> MakeCondition(const FrameView& image, ConditionKind kind,
                                           const Shape& shape);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_CONDITION_IMAGE_H_
