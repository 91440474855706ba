// SPDX-License-Identifier: Apache-2.0
#include "bench/shaky_warp.h"

#include <cmath>
#include <numbers>

#include "igf/base/rotation.h"

namespace rsstab::bench {

Camera FisheyeLens() {
  Camera lens = Camera::Pinhole(kWidth, kHeight, kFocalPx);
  lens.model = LensModel::kFisheye;
  lens.distortion = {0.03, -0.01, 0.0, 0.0};
  return lens;
}

stabilizer::FrameWarp ShakyWarp(double zoom) {
  stabilizer::FrameWarp warp;
  warp.width = kWidth;
  warp.height = kHeight;
  const Eigen::Matrix3d k = Camera::Pinhole(kWidth, kHeight, kFocalPx).K();
  const Eigen::Matrix3d zoomed = Camera::Pinhole(kWidth, kHeight, zoom * kFocalPx).K();
  const Eigen::Vector3d degrees(1.0, 1.0, 2.0);
  warp.rectified_from_output =
      k * ExpSo3<double>(degrees * (std::numbers::pi / 180.0)).toRotationMatrix() *
      zoomed.inverse();
  warp.mesh_update = MotionField(kWidth, kHeight, 17, 17);
  for (Eigen::Vector2f& update : warp.mesh_update.vertices()) {
    update = Eigen::Vector2f(1.0F, -1.0F);
  }
  warp.rs_field = MotionField(kWidth, kHeight, 17, 136);
  for (int r = 0; r < warp.rs_field.rows(); ++r) {
    const double phase = 2.0 * std::numbers::pi * 1.8 * r / warp.rs_field.rows();
    for (int c = 0; c < warp.rs_field.columns(); ++c) {
      warp.rs_field.At(c, r) =
          Eigen::Vector2d(15.0 * std::sin(phase), 7.0 * std::cos(phase)).cast<float>();
    }
  }
  return warp;
}

}  // namespace rsstab::bench
