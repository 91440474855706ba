// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_NORMALIZED_COORDINATES_H_
#define RSSTAB_STABILIZER_NORMALIZED_COORDINATES_H_

#include <Eigen/Core>

namespace rsstab::stabilizer {

// Motion between frames and camera paths are stated in normalised coordinates, the same at every
// image size: origin in the middle of the picture, x right, y down, the picture is 1 wide and
// height/width high (square pixels assumed by every rotation).
//   n = ((x + 0.5, y + 0.5) - (W, H) / 2) / W

// Figures that are said in "px" of normalised geometry mean pixels at this width.
inline constexpr double kReferenceWidthPx = 640.0;

[[nodiscard]] inline Eigen::Matrix3d NormalizedFromPixels(int width, int height) {
  const double s = 1.0 / width;
  Eigen::Matrix3d m;
  m << s, 0.0, (0.5 - width / 2.0) * s, 0.0, s, (0.5 - height / 2.0) * s, 0.0, 0.0, 1.0;
  return m;
}

[[nodiscard]] inline Eigen::Matrix3d PixelsFromNormalized(int width, int height) {
  const double w = width;
  Eigen::Matrix3d m;
  m << w, 0.0, width / 2.0 - 0.5, 0.0, w, height / 2.0 - 0.5, 0.0, 0.0, 1.0;
  return m;
}

[[nodiscard]] inline Eigen::Vector2d ToNormalized(const Eigen::Vector2d& pixel, int width,
                                                  int height) {
  return {(pixel.x() + 0.5 - width / 2.0) / width, (pixel.y() + 0.5 - height / 2.0) / width};
}

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_NORMALIZED_COORDINATES_H_
