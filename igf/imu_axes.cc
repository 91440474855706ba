// SPDX-License-Identifier: Apache-2.0
#include "igf/imu_axes.h"

#include <cctype>
#include <cstddef>
#include <string>
#include <utility>

namespace rsstab::igf {
namespace {

// Float32 matrices as cameras write them are exact permutations; this only admits rounding.
constexpr double kOrthonormalTolerance = 1e-3;

// What of a string from a file may appear in a message.
std::string Printable(std::string_view text) {
  constexpr std::size_t kLongest = 16;
  std::string safe;
  for (const char c : text.substr(0, kLongest)) {
    safe += std::isprint(static_cast<unsigned char>(c)) != 0 ? c : '?';
  }
  return text.size() > kLongest ? safe + "..." : safe;
}

}  // namespace

Result<Eigen::Matrix3d> ParseAxisString(std::string_view axes) {
  if (axes.size() != 3) {
    return Fail(ErrorCode::kInvalidArgument,
                "axis string \"{}\" has {} letters; three are needed, such as XYZ or YxZ",
                Printable(axes), axes.size());
  }
  Eigen::Matrix3d out_from_in = Eigen::Matrix3d::Zero();
  for (Eigen::Index row = 0; row < 3; ++row) {
    const char letter = axes[static_cast<std::size_t>(row)];
    const bool negative = letter >= 'x' && letter <= 'z';
    const bool positive = letter >= 'X' && letter <= 'Z';
    if (!negative && !positive) {
      return Fail(ErrorCode::kInvalidArgument,
                  "axis string \"{}\" has a letter other than X, Y, Z, x, y, z", Printable(axes));
    }
    out_from_in(row, letter - (negative ? 'x' : 'X')) = negative ? -1.0 : 1.0;
  }
  if ((out_from_in.cwiseAbs().colwise().sum().array() != 1.0).any()) {
    return Fail(ErrorCode::kInvalidArgument,
                "axis string \"{}\" names an axis twice; each of X, Y and Z must appear once",
                Printable(axes));
  }
  return out_from_in;
}

Eigen::Matrix3d CameraFromGyroflowAxes() {
  Eigen::Matrix3d camera_from_body;
  camera_from_body << 0, -1, 0,  // right = -left
      -1, 0, 0,                  // down = -up
      0, 0, -1;                  // forward = -back
  return camera_from_body;
}

Result<Eigen::Matrix3d> CameraFromGyroflowOrientation(std::string_view orientation) {
  return ParseAxisString(orientation).map([](const Eigen::Matrix3d& body_from_sensor) {
    return Eigen::Matrix3d(CameraFromGyroflowAxes() * body_from_sensor);
  });
}

Eigen::Matrix3d CameraFromGoProAxes() {
  Eigen::Matrix3d camera_from_body;
  camera_from_body << -1, 0, 0,  // right = -left
      0, 0, -1,                  // down = -up
      0, -1, 0;                  // forward = -back
  return camera_from_body;
}

Result<Eigen::Matrix3d> CameraFromGoProChannels(std::string_view orin) {
  return ParseAxisString(orin).map([](const Eigen::Matrix3d& channels_from_body) {
    return Eigen::Matrix3d(CameraFromGoProAxes() * channels_from_body.transpose());
  });
}

Result<Eigen::Matrix3d> CameraFromGoProMatrix(const Eigen::Matrix3d& mtrx, std::string_view orio) {
  Result<Eigen::Matrix3d> output_from_body = ParseAxisString(orio);
  if (!output_from_body) {
    return Propagate(std::move(output_from_body).error(), "ORIO");
  }
  const Eigen::Matrix3d defect = mtrx * mtrx.transpose() - Eigen::Matrix3d::Identity();
  if (!mtrx.allFinite() || defect.cwiseAbs().maxCoeff() > kOrthonormalTolerance) {
    return Fail(ErrorCode::kInvalidArgument, "MTRX is not a rotation or reflection of the axes");
  }
  return Eigen::Matrix3d(CameraFromGoProAxes() * output_from_body->transpose() * mtrx);
}

}  // namespace rsstab::igf
