// SPDX-License-Identifier: Apache-2.0
#include "igf/base/camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rsstab {
namespace {

constexpr double kMinDepth = 1e-9;
constexpr int kMaxIterations = 30;
constexpr double kConverged = 1e-12;

using Coefficients = std::array<double, 8>;

// theta_d of the OpenCV fisheye model and its derivative.
struct FisheyeAngle {
  double value;
  double slope;
};
FisheyeAngle DistortAngle(double theta, const Coefficients& k) {
  const double t2 = theta * theta;
  return {theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))),
          1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])))};
}

// Up to which angle the polynomial is believed. One that grows all the way to 90 degrees is
// believed so far. One that folds before is a calibration extrapolated beyond its data: it is
// believed until its slope falls below kMinSlopeRatio of the mean scale theta_d / theta (real
// lenses keep about 0.8: equisolid 0.79 at 90 degrees).
double BelievedAngle(const Coefficients& k) {
  constexpr double kRightAngle = std::numbers::pi / 2.0;
  constexpr int kSteps = 64;
  constexpr int kBisections = 40;
  constexpr double kMinSlope = 0.05;
  constexpr double kMinSlopeRatio = 0.7;
  bool folds = false;
  double below = 0.0;  // last step with a good slope before the first bad one
  bool found = false;
  for (int i = 1; i <= kSteps; ++i) {
    const double theta = kRightAngle * i / kSteps;
    const FisheyeAngle f = DistortAngle(theta, k);
    folds = folds || !(f.slope > kMinSlope);
    found = found || !(f.slope * theta > kMinSlopeRatio * f.value);
    if (!found) {
      below = theta;
    }
  }
  if (!folds) {
    return kRightAngle;
  }
  double above = below + kRightAngle / kSteps;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (below + above);
    const FisheyeAngle f = DistortAngle(middle, k);
    (f.slope * middle > kMinSlopeRatio * f.value ? below : above) = middle;
  }
  return below;
}

// Normalised, undistorted -> normalised, distorted, by the Brown-Conrady model.
Eigen::Vector2d DistortBrown(const Eigen::Vector2d& p, const Coefficients& k) {
  const double r2 = p.squaredNorm();
  const double radial =
      (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  const double xy = p.x() * p.y();
  return {p.x() * radial + 2.0 * k[2] * xy + k[3] * (r2 + 2.0 * p.x() * p.x()),
          p.y() * radial + k[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * k[3] * xy};
}

Eigen::Matrix2d BrownJacobian(const Eigen::Vector2d& p, const Coefficients& d) {
  constexpr double kStep = 1e-6;
  const Eigen::Vector2d dx(kStep, 0.0);
  const Eigen::Vector2d dy(0.0, kStep);
  Eigen::Matrix2d j;
  j.col(0) = (DistortBrown(p + dx, d) - DistortBrown(p - dx, d)) / (2.0 * kStep);
  j.col(1) = (DistortBrown(p + dy, d) - DistortBrown(p - dy, d)) / (2.0 * kStep);
  return j;
}

// Inverse of DistortAngle on [0, limit], where it grows. Newton steps, kept inside a bracket.
double UndistortAngle(double theta_d, double limit, const Coefficients& k) {
  double low = 0.0;
  double high = limit;
  double theta = std::min(theta_d, limit);
  for (int i = 0; i < kMaxIterations; ++i) {
    const FisheyeAngle f = DistortAngle(theta, k);
    (f.value < theta_d ? low : high) = theta;
    double next = theta - (f.value - theta_d) / f.slope;
    if (!(next >= low && next <= high)) {
      next = 0.5 * (low + high);
    }
    const double step = next - theta;
    theta = next;
    if (std::abs(step) < kConverged) {
      break;
    }
  }
  return theta;
}

std::optional<Eigen::Vector2d> UndistortBrown(const Eigen::Vector2d& distorted,
                                              const Coefficients& d) {
  Eigen::Vector2d p = distorted;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Matrix2d j = BrownJacobian(p, d);
    if (j.determinant() <= 0.0) {
      return std::nullopt;  // past the fold of the polynomial
    }
    const Eigen::Vector2d step = j.inverse() * (DistortBrown(p, d) - distorted);
    p -= step;
    if (!p.allFinite()) {
      return std::nullopt;
    }
    if (step.norm() < 1e-11) {
      return p;
    }
  }
  return std::nullopt;
}

}  // namespace

Camera Camera::Pinhole(int width, int height, double focal_px) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focal_px;
  camera.fy = focal_px;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

Status Camera::Validate() const {
  if (width < 1 || height < 1) {
    return Fail(ErrorCode::kInvalidArgument, "camera size {}x{} must be positive", width, height);
  }
  if (!(fx > 0.0) || !(fy > 0.0) || !std::isfinite(fx) || !std::isfinite(fy)) {
    return Fail(ErrorCode::kInvalidArgument, "focal length fx={} fy={} must be positive", fx, fy);
  }
  if (!std::isfinite(cx) || !std::isfinite(cy)) {
    return Fail(ErrorCode::kInvalidArgument, "principal point cx={} cy={} must be finite", cx, cy);
  }
  if (readout_s && !(std::abs(*readout_s) <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "readout time {} s must lie within -1 and 1",
                *readout_s);
  }
  const std::size_t n = distortion.size();
  const bool count_fits = (model == LensModel::kPinhole && n == 0) ||
                          (model == LensModel::kFisheye && n == 4) ||
                          (model == LensModel::kBrown && (n == 4 || n == 5 || n == 8));
  if (!count_fits) {
    return Fail(
        ErrorCode::kInvalidArgument,
        "{} distortion coefficients do not fit the lens model (pinhole 0, fisheye 4, brown 4, "
        "5 or 8)",
        n);
  }
  if (!std::all_of(distortion.begin(), distortion.end(),
                   [](double k) { return std::isfinite(k); })) {
    return Fail(ErrorCode::kInvalidArgument, "distortion coefficients must be finite numbers");
  }
  return {};
}

Eigen::Matrix3d Camera::K() const {
  Eigen::Matrix3d k;
  k << fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0;
  return k;
}

std::optional<Eigen::Vector2d> Camera::ProjectRay(const Eigen::Vector3d& ray) const {
  return CameraProjector(*this).ProjectRay(ray);
}

std::optional<Eigen::Vector3d> Camera::UnprojectPixel(const Eigen::Vector2d& pixel) const {
  return CameraProjector(*this).UnprojectPixel(pixel);
}

Camera Camera::Rescaled(int new_width, int new_height) const {
  const double sx = static_cast<double>(new_width) / width;
  const double sy = static_cast<double>(new_height) / height;
  Camera camera = *this;
  camera.width = new_width;
  camera.height = new_height;
  camera.fx = fx * sx;
  camera.fy = fy * sy;
  camera.cx = (cx + 0.5) * sx - 0.5;
  camera.cy = (cy + 0.5) * sy - 0.5;
  return camera;
}

CameraProjector::CameraProjector(const Camera& camera)
    : fx_(camera.fx), fy_(camera.fy), cx_(camera.cx), cy_(camera.cy), model_(camera.model) {
  std::copy_n(camera.distortion.begin(), std::min(camera.distortion.size(), k_.size()), k_.begin());
  if (model_ == LensModel::kFisheye) {
    line_theta_ = BelievedAngle(k_);
    const FisheyeAngle f = DistortAngle(line_theta_, k_);
    line_value_ = f.value;
    line_slope_ = f.slope;
  }
}

std::optional<Eigen::Vector2d> CameraProjector::ProjectRay(const Eigen::Vector3d& ray) const {
  Eigen::Vector2d p;
  if (model_ == LensModel::kFisheye) {
    const double radius = ray.head<2>().norm();
    const double theta = std::atan2(radius, ray.z());
    const double theta_d = theta < line_theta_ ? DistortAngle(theta, k_).value
                                               : line_value_ + line_slope_ * (theta - line_theta_);
    if (!std::isfinite(theta_d)) {
      return std::nullopt;
    }
    p = radius > 0.0 ? Eigen::Vector2d(ray.head<2>() * (theta_d / radius))
                     : Eigen::Vector2d::Zero();
  } else {
    if (!(ray.z() > kMinDepth)) {
      return std::nullopt;
    }
    p = ray.hnormalized();
    if (model_ == LensModel::kBrown) {
      if (BrownJacobian(p, k_).determinant() <= 0.0) {
        return std::nullopt;
      }
      p = DistortBrown(p, k_);
    }
  }
  return Eigen::Vector2d(fx_ * p.x() + cx_, fy_ * p.y() + cy_);
}

std::optional<Eigen::Vector3d> CameraProjector::UnprojectPixel(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d p((pixel.x() - cx_) / fx_, (pixel.y() - cy_) / fy_);
  switch (model_) {
    case LensModel::kPinhole:
      return Eigen::Vector3d(p.x(), p.y(), 1.0);
    case LensModel::kBrown: {
      const auto undistorted = UndistortBrown(p, k_);
      if (!undistorted) {
        return std::nullopt;
      }
      return Eigen::Vector3d(undistorted->x(), undistorted->y(), 1.0);
    }
    case LensModel::kFisheye: {
      const double radius = p.norm();
      if (radius < kMinDepth) {
        return Eigen::Vector3d(p.x(), p.y(), 1.0);
      }
      const double theta = radius < line_value_
                               ? UndistortAngle(radius, line_theta_, k_)
                               : line_theta_ + (radius - line_value_) / line_slope_;
      // Rays sideways or behind have no (x, y, 1) form.
      if (!(theta < std::numbers::pi / 2.0 - 1e-6)) {
        return std::nullopt;
      }
      return Eigen::Vector3d(p.x() * std::tan(theta) / radius, p.y() * std::tan(theta) / radius,
                             1.0);
    }
  }
  return std::nullopt;
}

}  // namespace rsstab
