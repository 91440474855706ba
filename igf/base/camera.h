// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_CAMERA_H_
#define RSSTAB_IGF_BASE_CAMERA_H_

#include <Eigen/Core>
#include <array>
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

  // Ray in camera axes (any length) -> pixel. Empty behind the camera (pinhole, Brown) or where the
  // Brown model folds. Where both are defined, the inverse of UnprojectPixel.
  //
  // A fisheye calibration seldom covers the image corners, and its polynomial often folds back
  // beyond the data. Such a lens is continued straight (theta_d linear in theta, same slope) from
  // where the slope falls well below the mean scale, so that every ray has one pixel.
  [[nodiscard]] std::optional<Eigen::Vector2d> ProjectRay(const Eigen::Vector3d& ray) const;

  // Pixel -> ray (x, y, 1) in camera axes. Empty where the lens model has no inverse: past the fold
  // of a Brown lens, 90 degrees or more off the axis of a fisheye lens.
  [[nodiscard]] std::optional<Eigen::Vector3d> UnprojectPixel(const Eigen::Vector2d& pixel) const;

  // The same lens on the same view at another image size: scales (c + 0.5) and f, per axis.
  [[nodiscard]] Camera Rescaled(int new_width, int new_height) const;
};

// The two mappings of one valid Camera for many points: same answers, but what depends on the lens
// alone is worked out once. Const methods may be called from several threads.
class CameraProjector {
 public:
  explicit CameraProjector(const Camera& camera);

  [[nodiscard]] std::optional<Eigen::Vector2d> ProjectRay(const Eigen::Vector3d& ray) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> UnprojectPixel(const Eigen::Vector2d& pixel) const;

 private:
  double fx_;
  double fy_;
  double cx_;
  double cy_;
  LensModel model_;
  std::array<double, 8> k_{};  // distortion, zero-filled
  // Fisheye: the polynomial holds up to this angle, a straight line from there on.
  double line_theta_ = 0.0;
  double line_value_ = 0.0;
  double line_slope_ = 1.0;
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_CAMERA_H_
