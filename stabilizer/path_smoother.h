// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PATH_SMOOTHER_H_
#define RSSTAB_STABILIZER_PATH_SMOOTHER_H_

#include <memory>
#include <optional>
#include <vector>

#include "igf/base/result.h"
#include "stabilizer/camera_path.h"

namespace rsstab::stabilizer {

struct PathSmootherOptions {
  double aspect = 9.0 / 16.0;  // picture height / width
  double frames_per_second = 30.0;
  double smoothness_s = 1.0;  // features of the path shorter than this are taken out; 0 = none
  bool tripod = false;        // stand still as far as the crop allows
  double min_crop_ratio =
      0.8;  // the path keeps a window of this share of a side inside the picture
  // True: the update zooms in as far as each moment needs, within min_crop_ratio. False: it never
  // does; one crop for the whole clip hides the borders.
  bool adaptive_zoom = true;
  double focal_ratio = 0.8;  // focal length / picture width: shape of the perspective of a turn
  // True when the motion comes from a sensor that knows rotations (a gyro): the update is then a
  // rotation, and zoom and shift only mop up.
  bool rotation_known = false;
  int mesh_columns = 16;
  int mesh_rows = 16;
  // Every frame is decided at the latest when this many more have been pushed; below 2 smoothness_s
  // the camera's intent beyond them is guessed. Empty: as many as serve the result best.
  std::optional<int> lookahead_frames;
};

// Turns a jerky bundle of camera paths into a smooth one, frame by frame with a look-ahead; bounded
// memory, linear time. Solver-free interface; in order, not thread safe.
class PathSmoother {
 public:
  virtual ~PathSmoother() = default;

  // Takes the motion of the next frame.
  [[nodiscard]] virtual Status Push(const FrameMotion& motion) = 0;

  // No more frames will come: everything left becomes ready.
  [[nodiscard]] virtual Status Finish() = 0;

  // Takes smoothness_s, tripod and min_crop_ratio of `options` for the frames not decided yet.
  // Errors: kInvalidArgument, and nothing changes.
  [[nodiscard]] virtual Status Update(const PathSmootherOptions& options) = 0;

  // Updates decided since the last call, one per frame, in order.
  [[nodiscard]] virtual std::vector<PathUpdate> TakeReady() = 0;
};

// The smoother that solves with Ceres. Errors: kInvalidArgument for options outside their range.
[[nodiscard]] Result<std::unique_ptr<PathSmoother>> MakeCeresPathSmoother(
    const PathSmootherOptions& options);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_PATH_SMOOTHER_H_
