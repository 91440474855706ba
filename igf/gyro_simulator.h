// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_SIMULATOR_H_
#define RSSTAB_IGF_GYRO_SIMULATOR_H_

#include <Eigen/Core>
#include <cstdint>

#include "igf/base/result.h"
#include "igf/gyro_log.h"
#include "igf/orientation_track.h"

namespace rsstab::igf {

struct GyroSimulatorOptions {
  double sampling_hz = 1000.0;  // 10..20000
  // Window over which a sample averages the rate, s, in (0, 1 / sampling_hz]. A short one is a
  // sensor without a low-pass filter.
  double averaging_s = 0.25e-3;
  double offset_s = 0.0;                                 // t_video = t_gyro + offset_s
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();  // added to every sample
  double noise_rad_s = 0.0;                              // standard deviation per axis, >= 0
  std::uint64_t noise_seed = 1;
};

// What a gyroscope on the camera would have logged. A sample at time t is the mean rate over
// [t - a/2, t + a/2], a = averaging_s, exactly: the logarithm of the relative rotation, over a.
// With a = 1 / sampling_hz, no bias and no noise, the product of exp(w_i a) therefore is the
// track's own orientation at the windows' edges, for any sampling rate.
//
// Samples cover [begin_s, end_s] of the track's clock (the video's), in camera axes.
// Errors: kInvalidArgument for options outside their ranges, or a track that does not cover
// [begin_s - a, end_s + a].
[[nodiscard]] Result<GyroLog> SimulateGyro(const OrientationTrack& orientation, double begin_s,
                                           double end_s, const GyroSimulatorOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_SIMULATOR_H_
