// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_INTEGRATOR_H_
#define RSSTAB_IGF_GYRO_INTEGRATOR_H_

#include <Eigen/Core>

#include "igf/base/result.h"
#include "igf/gyro_log.h"
#include "igf/orientation_track.h"

namespace rsstab::igf {

struct GyroIntegrationOptions {
  // Constant error of the sensor, rad/s in camera axes: true rate = reading - bias.
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();
  // Longest step, in (0, 1]. A log with a longer interval is interpolated: at 200 Hz, joining the
  // readings by straight lines loses 31% of a 60 Hz vibration, interpolating them 5%.
  double max_step_s = 0.5e-3;
  // Motion faster than this is taken out first, without delay (0 = nothing; has no effect on a log
  // sampled at less than three times this). Propellers and motors shake a sensor at 100 Hz and
  // more: one exposure averages that out of the picture, so the picture does not show what the log
  // says.
  double low_pass_hz = 0.0;
};

// Angular rate -> orientation: world_from_camera q <- q exp(w dt), with w the rate at the middle of
// the step. Starts at the identity; on the log's clock; the gaps of the log are gaps of the track.
// Between readings the rate is a polynomial through the eight nearest, or a straight line where
// those are unevenly spaced (ends of the log, gaps, jitter).
// Errors: kInvalidArgument for a step or low pass outside its range or a bias that is not finite.
[[nodiscard]] Result<OrientationTrack> IntegrateGyro(const GyroLog& log,
                                                     const GyroIntegrationOptions& options = {});

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_INTEGRATOR_H_
