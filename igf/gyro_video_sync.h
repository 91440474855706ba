// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_VIDEO_SYNC_H_
#define RSSTAB_IGF_GYRO_VIDEO_SYNC_H_

#include <Eigen/Core>
#include <span>

#include "igf/base/camera.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"
#include "igf/gyro_log.h"

namespace rsstab::igf {

struct GyroSyncOptions {
  // The offset is looked for within initial_offset_s +- search_s; search_s in [0, 60].
  double initial_offset_s = 0.0;
  double search_s = 2.0;
  // False: the camera's focal length, or its being a pinhole, is a guess, and the better one is
  // estimated as well. Only for cameras given as a pinhole (a lens profile knows both).
  bool focal_is_known = true;
  bool lens_is_known = true;
};

// One standard deviation is that of the fit, allowing for errors that all tracks of a frame share;
// 0 where the value was given.
struct GyroSyncResult {
  double offset_s = 0.0;  // t_video = t_gyro + offset_s, video times being those of middle rows
  double offset_sigma_s = 0.0;
  // The camera as given, with what was estimated in its place: focal length, lens (a fisheye when
  // the clip shows one, good for the image and a little beyond), readout.
  Camera camera;
  double focal_ratio = 1.0;  // estimated over assumed focal length, both axes
  double focal_ratio_sigma = 0.0;
  double readout_s = 0.0;  // signed, first row to last
  double readout_sigma_s = 0.0;
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();  // true rate = reading - bias
  // Whether the clip determines these; true where they were given. A steady pan, for one, skews
  // every frame alike and says nothing about the readout. Not trusted: the value is little more
  // than the prior.
  bool focal_is_trusted = false;
  bool readout_is_trusted = false;
  // Typical track residual with the gyro's rotation and without any, px of the tracks' size.
  double rms_px = 0.0;
  double rms_without_gyro_px = 0.0;
  double confidence = 0.0;  // (0, 1]: 1 = nothing left to doubt
};

// Estimates where a gyro log lies on the video's clock, the gyro's bias and, where they are not
// given, readout time (camera.readout_s unset), focal length and lens: an exhaustive search over
// the offset, then robust nonlinear least squares on row-timed tracks from the best few candidates.
//
// `tracks`: matches between consecutive frames, any order of pairs; at least 15 pairs with matches,
// 1 s or more to be useful. `camera`: of any image size (rescaled to that of the tracks). The log
// may begin late or end early; frames beyond it are left out. Errors: kInvalidArgument for bad
// options or camera; kUntrustworthy, with the reason, when the log does not overlap the clip, the
// camera hardly turns, the log does not fit the motion, or several offsets fit alike.
[[nodiscard]] Result<GyroSyncResult> SynchronizeGyro(std::span<const PointTracks> tracks,
                                                     const GyroLog& log, const Camera& camera,
                                                     const GyroSyncOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_VIDEO_SYNC_H_
