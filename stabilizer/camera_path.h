// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_CAMERA_PATH_H_
#define RSSTAB_STABILIZER_CAMERA_PATH_H_

#include <Eigen/Core>
#include <vector>

#include "stabilizer/global_motion.h"

namespace rsstab::stabilizer {

// How the camera moved from the previous frame to this one, normalised coordinates. The bundle of
// camera paths C_i(t) of Liu et al. 2013 is the chain of these: C_i(t) = C_i(t-1) F_i(t-1), with
// F_i = (to_from + local)^-1 at cell i.
struct FrameMotion {
  Eigen::Matrix3d to_from = Eigen::Matrix3d::Identity();  // previous frame -> this one
  std::vector<Eigen::Vector2d> local;  // extra displacement per mesh vertex; empty = none
  MotionRung rung = MotionRung::kHold;
  bool path_begins = false;  // first frame, or a scene cut: nothing connects it to the previous one
};

// What takes a frame from its camera path C to the smooth path P, normalised coordinates: an output
// pixel q shows the rectified frame's pixel
//   p + mesh_update(p),  p = rectified_from_output q.
// Crop and zoom are not in it.
struct PathUpdate {
  Eigen::Matrix3d rectified_from_output = Eigen::Matrix3d::Identity();
  std::vector<Eigen::Vector2d> mesh_update;  // per mesh vertex; empty = none
  MotionRung rung = MotionRung::kHold;
  bool path_begins = false;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_CAMERA_PATH_H_
