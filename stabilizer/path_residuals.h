// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PATH_RESIDUALS_H_
#define RSSTAB_STABILIZER_PATH_RESIDUALS_H_

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "stabilizer/normalized_coordinates.h"
#include "stabilizer/update_parameters_detail.h"

namespace rsstab::stabilizer {

// Motion is looked at in four points near the corners; residuals are in pixels at
// kReferenceWidthPx.
inline constexpr std::size_t kNumPathPoints = 4;
using PathPoints = std::array<Eigen::Vector2d, kNumPathPoints>;
inline constexpr double kPathPointShare = 0.8;  // of the half width and half height

[[nodiscard]] inline PathPoints MakePathPoints(double aspect) {
  const double x = 0.5 * kPathPointShare;
  const double y = 0.5 * kPathPointShare * aspect;
  return {{{-x, -y}, {x, -y}, {-x, y}, {x, y}}};
}

// Where output point q of one frame lies in the output of the next:
//   M = B(next)^-1 F B(current), F: rectified current frame -> rectified next frame
template <typename T>
[[nodiscard]] Point2<T> OutputMotion(const T* theta, const T* theta_next, const Eigen::Matrix3d& f,
                                     double focal_ratio, const Eigen::Vector2d& q) {
  const Point2<T> in_current = ApplyUpdate<T>(theta, focal_ratio, q.cast<T>());
  const T w = f(2, 0) * in_current.x() + f(2, 1) * in_current.y() + f(2, 2);
  const Point2<T> in_next((f(0, 0) * in_current.x() + f(0, 1) * in_current.y() + f(0, 2)) / w,
                          (f(1, 0) * in_current.x() + f(1, 1) * in_current.y() + f(1, 2)) / w);
  return ApplyInverseUpdate<T>(theta_next, focal_ratio, in_next);
}

// Two residuals for every point: `difference(point)`, weighted, in pixels.
template <typename T, typename Difference>
void PointResiduals(const PathPoints& points, double weight, const Difference& difference,
                    T* residual) {
  for (std::size_t i = 0; i < kNumPathPoints; ++i) {
    const Point2<T> r = difference(points[i]) * T(weight * kReferenceWidthPx);
    residual[2 * i] = r.x();
    residual[2 * i + 1] = r.y();
  }
}

// |P(t) - C(t)|: how far the update moves the picture (zoom apart: that is what hides borders, and
// has a price of its own); plus the reluctance to use anything but a turn.
struct DataResidual {
  PathPoints points;
  double focal_ratio = 0.8;
  double weight = 1.0;
  std::array<double, kUpdateSize> reluctance{};  // per component of theta, px per unit

  static constexpr int kSize = 2 * static_cast<int>(kNumPathPoints) + kUpdateSize;

  template <typename T>
  bool operator()(const T* theta, T* residual) const {
    std::array<T, kUpdateSize> unzoomed;
    std::copy(theta, theta + kUpdateSize, unzoomed.begin());
    unzoomed[kZoomIndex] = T(0.0);
    const auto moved = [&](const Eigen::Vector2d& q) -> Point2<T> {
      return ApplyUpdate<T>(unzoomed.data(), focal_ratio, q.cast<T>()) - q.cast<T>();
    };
    PointResiduals(points, weight, moved, residual);
    for (std::size_t k = 0; k < reluctance.size(); ++k) {
      residual[2 * kNumPathPoints + k] = reluctance[k] * theta[k];
    }
    return true;
  }
};

// Change of the output's motion over three frames (its acceleration): zero for a camera that pans
// steadily or stands still.
struct AccelerationResidual {
  PathPoints points;
  double focal_ratio = 0.8;
  double weight = 1.0;
  Eigen::Matrix3d f0 = Eigen::Matrix3d::Identity();  // frame 0 -> 1
  Eigen::Matrix3d f1 = Eigen::Matrix3d::Identity();  // frame 1 -> 2

  static constexpr int kSize = 2 * static_cast<int>(kNumPathPoints);

  template <typename T>
  bool operator()(const T* t0, const T* t1, const T* t2, T* residual) const {
    const auto change = [&](const Eigen::Vector2d& q) -> Point2<T> {
      return OutputMotion<T>(t1, t2, f1, focal_ratio, q) -
             OutputMotion<T>(t0, t1, f0, focal_ratio, q);
    };
    PointResiduals(points, weight, change, residual);
    return true;
  }
};

// Change of that acceleration over four frames (jerk).
struct JerkResidual {
  PathPoints points;
  double focal_ratio = 0.8;
  double weight = 1.0;
  Eigen::Matrix3d f0 = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d f1 = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d f2 = Eigen::Matrix3d::Identity();

  static constexpr int kSize = 2 * static_cast<int>(kNumPathPoints);

  template <typename T>
  bool operator()(const T* t0, const T* t1, const T* t2, const T* t3, T* residual) const {
    const auto change = [&](const Eigen::Vector2d& q) -> Point2<T> {
      return OutputMotion<T>(t2, t3, f2, focal_ratio, q) -
             OutputMotion<T>(t1, t2, f1, focal_ratio, q) * T(2.0) +
             OutputMotion<T>(t0, t1, f0, focal_ratio, q);
    };
    PointResiduals(points, weight, change, residual);
    return true;
  }
};

// The output's motion itself; with a tripod it shall be zero.
struct VelocityResidual {
  PathPoints points;
  double focal_ratio = 0.8;
  double weight = 1.0;
  Eigen::Matrix3d f0 = Eigen::Matrix3d::Identity();

  static constexpr int kSize = 2 * static_cast<int>(kNumPathPoints);

  template <typename T>
  bool operator()(const T* t0, const T* t1, T* residual) const {
    const auto motion = [&](const Eigen::Vector2d& q) -> Point2<T> {
      return OutputMotion<T>(t0, t1, f0, focal_ratio, q) - q.cast<T>();
    };
    PointResiduals(points, weight, motion, residual);
    return true;
  }
};

// How far the corners of a centred window leave the picture, seen through the update with or
// without its zoom. Zero inside.
struct CropResidual {
  double focal_ratio = 0.8;
  double weight = 1.0;
  double crop_ratio = 0.8;
  double aspect = 9.0 / 16.0;
  bool with_zoom = false;

  static constexpr int kSize = 8;

  template <typename T>
  bool operator()(const T* theta, T* residual) const {
    const double x = 0.5 * crop_ratio;
    const double y = 0.5 * crop_ratio * aspect;
    const std::array<Eigen::Vector2d, 4> corners = {{{-x, -y}, {x, -y}, {-x, y}, {x, y}}};
    std::array<T, kUpdateSize> update;
    std::copy(theta, theta + kUpdateSize, update.begin());
    if (!with_zoom) {
      update[kZoomIndex] = T(0.0);
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Point2<T> moved = ApplyUpdate<T>(update.data(), focal_ratio, corners[i].cast<T>());
      residual[2 * i] = Overhang(moved.x(), 0.5);
      residual[2 * i + 1] = Overhang(moved.y(), 0.5 * aspect);
    }
    return true;
  }

 private:
  template <typename T>
  [[nodiscard]] T Overhang(const T& position, double limit) const {
    const double scale = weight * kReferenceWidthPx;
    if (position > T(limit)) {
      return (position - limit) * scale;
    }
    if (position < T(-limit)) {
      return (position + limit) * scale;
    }
    return T(0.0);
  }
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_PATH_RESIDUALS_H_
