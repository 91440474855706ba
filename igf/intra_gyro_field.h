// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_INTRA_GYRO_FIELD_H_
#define RSSTAB_IGF_INTRA_GYRO_FIELD_H_

#include "igf/base/camera.h"
#include "igf/base/motion_field.h"
#include "igf/base/readout_motion.h"
#include "igf/base/result.h"
#include "igf/orientation_track.h"

namespace rsstab::igf {

// How the rows of a frame moved, read off an orientation track. `track` on the video clock;
// `frame_time_s` is the time of the middle row; `readout_s` signed, first row to last (0 = global
// shutter: both maps are the identity, and the track is not asked); `reference_row` in rows,
// usually (height - 1) / 2. Errors: kInvalidArgument for a camera, time or row that makes no sense;
// kUntrustworthy when the track does not cover the readout and the reference row.
[[nodiscard]] Result<ReadoutMotion> ComputeReadoutMotion(const Camera& camera,
                                                         const OrientationTrack& track,
                                                         double frame_time_s, double readout_s,
                                                         double reference_row);

// The intra-gyro field: backward displacement of the frame's readout, reference row the middle.
// Displaces every vertex by RsFromGs; a vertex whose pixel has no ray (beyond the image circle)
// takes the displacement of the nearest pixel towards the principal point that has one.
// Errors: those of ComputeReadoutMotion; kInvalidArgument for a grid below 2x2.
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
