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

// theta_d of the OpenCV fisheye model and its derivative.
struct FisheyeAngle {
  double value;
  double slope;
};
FisheyeAngle DistortAngle(double theta, const std::vector<double>& k) {
  const double t2 = theta * theta;
  const double k1 = k[0];
  const double k2 = k[1];
  const double k3 = k[2];
  const double k4 = k[3];
  return {theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4)))),
          1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))};
}

// Normalised, undistorted -> normalised, distorted, by the Brown-Conrady model.
Eigen::Vector2d DistortBrown(const Eigen::Vector2d& p, const std::vector<double>& d) {
  std::array<double, 8> k{};
  std::copy(d.begin(), d.end(), k.begin());
  const double r2 = p.squaredNorm();
  const double radial =
      (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  const double xy = p.x() * p.y();
  return {p.x() * radial + 2.0 * k[2] * xy + k[3] * (r2 + 2.0 * p.x() * p.x()),
          p.y() * radial + k[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * k[3] * xy};
}

Eigen::Matrix2d BrownJacobian(const Eigen::Vector2d& p, const std::vector<double>& d) {
  constexpr double kStep = 1e-6;
  const Eigen::Vector2d dx(kStep, 0.0);
  const Eigen::Vector2d dy(0.0, kStep);
  Eigen::Matrix2d j;
  j.col(0) = (DistortBrown(p + dx, d) - DistortBrown(p - dx, d)) / (2.0 * kStep);
  j.col(1) = (DistortBrown(p + dy, d) - DistortBrown(p - dy, d)) / (2.0 * kStep);
  return j;
}

std::optional<double> UndistortAngle(double theta_d, const std::vector<double>& k) {
  double theta = theta_d;
  for (int i = 0; i < kMaxIterations; ++i) {
    const FisheyeAngle f = DistortAngle(theta, k);
    if (f.slope <= 0.0) {
      return std::nullopt;  // past the fold: two angles share this radius
    }
    const double step = (f.value - theta_d) / f.slope;
    theta -= step;
    if (theta < 0.0 || theta >= std::numbers::pi) {
      return std::nullopt;
    }
    if (std::abs(step) < kConverged) {
      return theta;
    }
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> UndistortBrown(const Eigen::Vector2d& distorted,
                                              const std::vector<double>& d) {
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
  Eigen::Vector2d p;
  if (model == LensModel::kFisheye) {
    const double radius = ray.head<2>().norm();
    const double theta = std::atan2(radius, ray.z());
    const FisheyeAngle f = DistortAngle(theta, distortion);
    if (f.slope <= 0.0 || !std::isfinite(f.value)) {
      return std::nullopt;
    }
    p = radius > 0.0 ? Eigen::Vector2d(ray.head<2>() * (f.value / radius))
                     : Eigen::Vector2d::Zero();
  } else {
    if (!(ray.z() > kMinDepth)) {
      return std::nullopt;
    }
    p = ray.hnormalized();
    if (model == LensModel::kBrown) {
      if (BrownJacobian(p, distortion).determinant() <= 0.0) {
        return std::nullopt;
      }
      p = DistortBrown(p, distortion);
    }
  }
  return Eigen::Vector2d(fx * p.x() + cx, fy * p.y() + cy);
}

std::optional<Eigen::Vector3d> Camera::UnprojectPixel(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d p((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  switch (model) {
    case LensModel::kPinhole:
      return Eigen::Vector3d(p.x(), p.y(), 1.0);
    case LensModel::kBrown: {
      const auto undistorted = UndistortBrown(p, distortion);
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
      const auto theta = UndistortAngle(radius, distortion);
      // Rays sideways or behind have no (x, y, 1) form.
      if (!theta || *theta >= std::numbers::pi / 2.0 - 1e-6) {
        return std::nullopt;
      }
      return Eigen::Vector3d(p.x() * std::tan(*theta) / radius, p.y() * std::tan(*theta) / radius,
                             1.0);
    }
  }
  return std::nullopt;
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

}  // namespace rsstab
