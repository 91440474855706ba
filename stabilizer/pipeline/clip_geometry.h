// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PIPELINE_CLIP_GEOMETRY_H_
#define RSSTAB_STABILIZER_PIPELINE_CLIP_GEOMETRY_H_

namespace rsstab::pipeline {

// What every stage must know about the clip before the first frame.
struct ClipGeometry {
  int width = 0;  // full size, px
  int height = 0;
  double frames_per_second = 30.0;
};

}  // namespace rsstab::pipeline

#endif  // RSSTAB_STABILIZER_PIPELINE_CLIP_GEOMETRY_H_
