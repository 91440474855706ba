// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_METRIC_RESIDUALS_H_
#define RSSTAB_STABILIZER_METRICS_METRIC_RESIDUALS_H_

#include <Eigen/Core>

#include "igf/base/rotation.h"

namespace rsstab::stabilizer {

// H from - to for h = (h11 h12 h13 h21 h22 h23 h31 h32), h33 = 1. Any unit: callers hand in
// coordinates of order one, so that the eight parameters are of similar size.
struct HomographyResidual {
  Eigen::Vector2d from;
  Eigen::Vector2d to;

  template <typename T>
  bool operator()(const T* h, T* residual) const {
    const T w = h[6] * from.x() + h[7] * from.y() + 1.0;
    if (!(w > 1e-6)) {
      return false;
    }
    residual[0] = (h[0] * from.x() + h[1] * from.y() + h[2]) / w - to.x();
    residual[1] = (h[3] * from.x() + h[4] * from.y() + h[5]) / w - to.y();
    return true;
  }
};

// f (pi(R ray) - to), where ray = ((from - c) e^log_zoom / f, 1): a camera with focal length f
// turned by the rotation vector and zoomed about its centre. Residual in the unit of f (px).
struct RotationZoomResidual {
  double focal_px;
  Eigen::Vector2d from_px;  // relative to the principal point
  Eigen::Vector2d to_px;    // relative to the principal point

  // parameters: rotation vector (rad), log of the zoom
  template <typename T>
  bool operator()(const T* parameters, T* residual) const {
    using std::exp;
    const Eigen::Matrix<T, 3, 1> rotation(parameters[0], parameters[1], parameters[2]);
    const T zoom = exp(parameters[3]) / focal_px;
    const Eigen::Matrix<T, 3, 1> ray(from_px.x() * zoom, from_px.y() * zoom, T(1.0));
    const Eigen::Matrix<T, 3, 1> turned = ExpSo3(rotation) * ray;
    if (!(turned.z() > 1e-6)) {
      return false;
    }
    residual[0] = turned.x() / turned.z() * focal_px - to_px.x();
    residual[1] = turned.y() / turned.z() * focal_px - to_px.y();
    return true;
  }
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_METRIC_RESIDUALS_H_
