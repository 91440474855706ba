// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_CAMERA_H_
#define RSSTAB_IGF_BASE_CAMERA_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "igf/base/result.h"

namespace rsstab {

// Which formula bends a ray on its way to a pixel.
enum class LensModel {
  kPinhole,  // none
  kFisheye,  // OpenCV fisheye (Kannala-Brandt): theta_d = theta (1 + k1 theta^2 + .. + k4 theta^8)
  kBrown,    // OpenCV Brown-Conrady: k1 k2 p1 p2 [k3 [k4 k5 k6]]
};

// Intrinsics of one image size. Camera axes: x right, y down, z forward. Pixels: x right, y down,
// centres at integers.
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0.0;  // px
  double fy = 0.0;  // px
  double cx = 0.0;  // px
  double cy = 0.0;  // px
  LensModel model = LensModel::kPinhole;
  std::vector<double> distortion;   // empty, 4 (fisheye), 4, 5 or 8 (Brown) coefficients
  std::optional<double> readout_s;  // signed; see rolling_shutter.h

  // A pinhole with its centre in the middle of the image.
  [[nodiscard]] static Camera Pinhole(int width, int height, double focal_px);

  // kInvalidArgument with the value and the rule it broke, or nothing.
  [[nodiscard]] Status Validate() const;

  // [fx 0 cx; 0 fy cy; 0 0 1] of this size.
  [[nodiscard]] Eigen::Matrix3d K() const;

  // Ray in camera axes (any length) -> pixel. Empty behind the camera or where the lens model
  // folds.
  [[nodiscard]] std::optional<Eigen::Vector2d> ProjectRay(const Eigen::Vector3d& ray) const;

  // Pixel -> ray (x, y, 1) in camera axes. Empty where the lens model has no inverse (outside the
  // image circle).
  [[nodiscard]] std::optional<Eigen::Vector3d> UnprojectPixel(const Eigen::Vector2d& pixel) const;

  // The same lens on the same view at another image size: scales (c + 0.5) and f, per axis.
  [[nodiscard]] Camera Rescaled(int new_width, int new_height) const;
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_CAMERA_H_
