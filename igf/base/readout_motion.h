// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_READOUT_MOTION_H_
#define RSSTAB_IGF_BASE_READOUT_MOTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"

namespace rsstab {

// How one frame's rows moved against its reference row, for a camera that only turns. A rolling-
// shutter (RS) pixel lies in the recorded frame; a global-shutter (GS) pixel in the picture that a
// camera frozen at the reference row's instant would have taken. Rows outside the frame count as
// exposed with the first or last row. Const methods may be called from several threads.
class ReadoutMotion {
 public:
  // How many evenly spaced rows describe a frame of `height` rows well: 30 ms of readout then has
  // them 0.12 ms apart, so that a straight line between two rotations is off by less than 0.01 px
  // even at 60 Hz of vibration.
  [[nodiscard]] static int KnotCount(int height);

  // `camera_row_from_reference`: unit quaternions R(t_row) R_ref^T at evenly spaced rows, the first
  // at row 0, the last at row height - 1; at least 2. Matrices in between are linear.
  // Errors: kInvalidArgument for an invalid camera, too few rotations or one that is not finite.
  [[nodiscard]] static Result<ReadoutMotion> Create(
      const Camera& camera, std::span<const Eigen::Quaterniond> camera_row_from_reference);

  // Where the direction of a GS pixel was recorded: the fixed point p = H(t(p.y)) x. Empty where
  // the lens has no such ray.
  [[nodiscard]] std::optional<Eigen::Vector2d> RsFromGs(const Eigen::Vector2d& gs_pixel) const;

  // Where an RS pixel belongs: H_{ref <- t(p.y)} p, exact in one step. Empty as above.
  [[nodiscard]] std::optional<Eigen::Vector2d> GsFromRs(const Eigen::Vector2d& rs_pixel) const;

 private:
  explicit ReadoutMotion(const Camera& camera);

  // Row rotation (or homography) at a row, from the table.
  [[nodiscard]] Eigen::Matrix3d AtRow(double row) const;

  CameraProjector lens_;
  bool is_pinhole_;
  double last_row_;
  // Evenly spaced from row 0 to last_row_: K R(t) R_ref^T K^-1 for a pinhole, R(t) R_ref^T for any
  // other lens.
  std::vector<Eigen::Matrix3d> row_from_ref_;
};

// Vertices of a computed field.
struct FieldGrid {
  int columns = 17;  // at least 2
  int rows = 65;     // at least 2
};

// A zero field of the camera's image size, reference row the middle.
// Errors: kInvalidArgument for an invalid camera or a grid below 2x2.
[[nodiscard]] Result<MotionField> MakeField(const Camera& camera, const FieldGrid& grid);

// Where a pixel goes; empty where the lens has no such ray.
using PixelMap = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d&)>;

// Displaces every vertex by map(vertex) - vertex. A vertex whose pixel has no ray (beyond the image
// circle) takes the displacement of the nearest pixel towards the principal point that has one.
void FillField(const Camera& camera, const PixelMap& map, MotionField& field);

// The field of a readout motion: every vertex displaced by RsFromGs; `camera` as given to Create.
// The motion's reference is taken to be the middle row.
// Errors: those of MakeField.
[[nodiscard]] Result<MotionField> ComputeReadoutField(const Camera& camera,
                                                      const ReadoutMotion& motion,
                                                      const FieldGrid& grid = {});

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_READOUT_MOTION_H_
