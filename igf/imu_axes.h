// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_IMU_AXES_H_
#define RSSTAB_IGF_IMU_AXES_H_

#include <Eigen/Core>
#include <string_view>

#include "igf/base/result.h"

namespace rsstab::igf {

// How the axes of an inertial sensor lie in the camera. Every function returns a 3x3 matrix that
// takes a column of three readings to three others, `target_from_source`; camera axes are x right,
// y down, z forward. All functions are pure: any thread.
//
// Body axes in which vendors state their logs, for a camera that looks forward, upright:
//   Gyroflow  x up,    y left,  z back      camera = (-y, -x, -z)
//   GoPro     X left,  Y back,  Z up        camera = (-X, -Z, -Y)
// Both are right-handed. (GoPro writes its channels in the order Z, X, Y, which is Gyroflow's x, y,
// z; the pan at the end of a GoPro Karma clip confirms the yaw's sign.)

// An axis string in Gyroflow's "IMU orientation" sense: letter k names the input axis that
// supplies output k, lower case negates. "YxZ": out = (in.y, -in.x, in.z).
// Errors: kInvalidArgument unless it is three letters that name each of x, y, z once. A mirroring
// string (one that no rigid mount can produce) is allowed: loggers with a flipped sign exist.
[[nodiscard]] Result<Eigen::Matrix3d> ParseAxisString(std::string_view axes);

// Gyroflow body axes -> camera axes: (x, y, z) -> (-y, -x, -z).
[[nodiscard]] Eigen::Matrix3d CameraFromGyroflowAxes();

// Sensor readings -> camera axes for a log with a Gyroflow IMU orientation string.
// Errors: as ParseAxisString.
[[nodiscard]] Result<Eigen::Matrix3d> CameraFromGyroflowOrientation(std::string_view orientation);

// GoPro body axes (X, Y, Z) -> camera axes: (-X, -Z, -Y).
[[nodiscard]] Eigen::Matrix3d CameraFromGoProAxes();

// GPMF's ORIN: stored channel k measures the body axis named by letter k, lower case negated.
// "YxZ": channels = (Y, -X, Z). Returns camera_from_channels.
// Errors: as ParseAxisString.
[[nodiscard]] Result<Eigen::Matrix3d> CameraFromGoProChannels(std::string_view orin);

// GPMF's MTRX: output = matrix * channels, where output row j is the body axis named by letter j of
// ORIO ("ZXY" as cameras write it). Returns camera_from_channels.
// Errors: kInvalidArgument when ORIO is no axis string or the matrix is not orthonormal to 1e-3.
[[nodiscard]] Result<Eigen::Matrix3d> CameraFromGoProMatrix(const Eigen::Matrix3d& mtrx,
                                                            std::string_view orio);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_IMU_AXES_H_
