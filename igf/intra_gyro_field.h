// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_INTRA_GYRO_FIELD_H_
#define RSSTAB_IGF_INTRA_GYRO_FIELD_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"
#include "igf/orientation_track.h"

namespace rsstab::igf {

// How one frame's rows moved against its reference row, for a camera that only turns. A rolling-
// shutter (RS) pixel lies in the recorded frame; a global-shutter (GS) pixel in the picture that a
// camera frozen at the reference row's instant would have taken. Rows outside the frame count as
// exposed with the first or last row. Const methods may be called from several threads.
class ReadoutMotion {
 public:
  // `track` on the video clock; `frame_time_s` is the time of the middle row; `readout_s` signed,
  // first row to last (0 = global shutter: both maps are the identity, and the track is not asked);
  // `reference_row` in rows, usually (height - 1) / 2.
  // Errors: kInvalidArgument for a camera, time or row that makes no sense; kUntrustworthy when the
  // track does not cover the readout and the reference row.
  [[nodiscard]] static Result<ReadoutMotion> Create(const Camera& camera,
                                                    const OrientationTrack& track,
                                                    double frame_time_s, double readout_s,
                                                    double reference_row);

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

// Vertices of the computed field.
struct FieldGrid {
  int columns = 17;  // at least 2
  int rows = 65;     // at least 2
};

// The intra-gyro field: backward displacement of the frame's readout, reference row the middle.
// Displaces every vertex by RsFromGs; a vertex whose pixel has no ray (beyond the image circle)
// takes the displacement of the nearest pixel towards the principal point that has one.
// Errors: those of ReadoutMotion; kInvalidArgument for a grid below 2x2.
[[nodiscard]] Result<MotionField> ComputeIntraGyroField(const Camera& camera,
                                                        const OrientationTrack& track,
                                                        double frame_time_s, double readout_s,
                                                        const FieldGrid& grid = {});

// How RS-Real's labels were made.
struct BandFieldOptions {
  int bands = 8;           // row bands of equal height, 1 .. height
  int reference_band = 0;  // 0 .. bands - 1; RS-Real: the first
  FieldGrid grid;
};

// The same field in the paper's one-step form: every grid point is moved by the homography of the
// band it lies in, H_i = K R(t_i) R_ref^T K^-1 with t_i the time of the band's middle row, without
// asking in which band it ends up. Off by the field's change over its own length: use it to make or
// compare labels, not to correct pictures. Reference row: the middle of the reference band.
// Errors: those of ComputeIntraGyroField; kInvalidArgument for bands outside their range.
[[nodiscard]] Result<MotionField> ComputeBandField(const Camera& camera,
                                                   const OrientationTrack& track,
                                                   double frame_time_s, double readout_s,
                                                   const BandFieldOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_INTRA_GYRO_FIELD_H_
