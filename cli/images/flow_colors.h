// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_FLOW_COLORS_H_
#define RSSTAB_CLI_IMAGES_FLOW_COLORS_H_

#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/parallel_for.h"
#include "igf/base/result.h"

namespace rsstab::images {

// A field as a picture of its size, packed RGB, 8 bits: the hue tells the direction and the
// saturation the length, as a share of the longest displacement in the field, or of `full_px` where
// that is given, so that several pictures have one scale (white: none). The
// wheel is that of Baker et al., A Database and Evaluation Methodology for Optical Flow, IJCV 2011
// (red to the right, yellow down, cyan to the left, blue to purple up), closed so that there is no
// seam at red.
// Errors: those of AllocateFrame.
[[nodiscard]] Result<Frame> FlowColors(const MotionField& field, WorkerPool& workers,
                                       double full_px = 0.0);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_FLOW_COLORS_H_
