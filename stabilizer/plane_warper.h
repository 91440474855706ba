// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PLANE_WARPER_H_
#define RSSTAB_STABILIZER_PLANE_WARPER_H_

#include <array>

#include "igf/base/frame.h"
#include "igf/base/parallel_for.h"
#include "igf/base/result.h"
#include "stabilizer/backward_map.h"
#include "stabilizer/interpolation.h"
#include "stabilizer/resample_kernels.h"

namespace rsstab::stabilizer {

// What shows where the source lies outside the picture.
enum class OutsidePixels {
  kBlack,
  kNearestEdge,  // the edge goes on
};

// Resamples a picture through a backward map: once per plane, in the picture's own format. Planar,
// semi-planar and packed layouts of 8 to 16 bits.
//
// Chroma planes are reached from luma coordinates here and nowhere else: chroma sample (i, j) sits
// on luma position (i 2^shift_x + offset_x, j 2^shift_y + offset_y) of the layout.
//
// Source positions are rounded to 1 / kPhases of a pixel of the plane. Filter taps beyond the edge
// repeat the edge; what a pixel becomes whose source lies more than half a pixel outside its plane
// is the caller's choice. A source that is not a number lies outside.
//
// Any order of frames. The result does not depend on the number of threads, nor on the kernels.
class PlaneWarper {
 public:
  explicit PlaneWarper(KernelSet kernels = BestKernelSet());

  // Fills `destination`, allocated by the caller with the layout and size of `source`; they must
  // not share memory. `map` must be of that size, too. Strides are free on both sides.
  // kInvalidArgument when sizes or layouts differ or a plane is missing.
  [[nodiscard]] Status Warp(const FrameView& source, const BackwardMap& map,
                            Interpolation interpolation, Frame& destination, WorkerPool& workers,
                            OutsidePixels outside = OutsidePixels::kBlack) const;

 private:
  KernelSet kernels_;
  std::array<FilterBank, 3> filters_;  // by Interpolation
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_PLANE_WARPER_H_
