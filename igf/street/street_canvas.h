// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_STREET_STREET_CANVAS_H_
#define RSSTAB_IGF_STREET_STREET_CANVAS_H_

#include <cstdint>
#include <initializer_list>
#include <opencv2/core.hpp>

#include "igf/scene_painter.h"

namespace rsstab::igf {

// RGB, 0..255. Inside this folder only; no header outside it shows OpenCV.
using StreetColor = cv::Vec3d;

[[nodiscard]] inline StreetColor Mix(const StreetColor& a, const StreetColor& b,
                                     double share_of_b) {
  return a * (1.0 - share_of_b) + b * share_of_b;
}

// Places of the painted street, in units of tangent (wall distances): x from -2 to 2, left to
// right; y downwards, 0 at eye level.
inline constexpr double kStreetLeft = -kPaintedWidthTan / 2.0;
inline constexpr double kStreetRight = kPaintedWidthTan / 2.0;
inline constexpr double kHouseFoot = 0.15;  // where houses meet the pavement
inline constexpr double kKerb = 0.23;       // where the pavement meets the road

// Shapes with smooth edges, placed in units of tangent on a picture of any resolution.
class StreetCanvas {
 public:
  StreetCanvas(int width, int height, std::uint64_t seed)
      : seed_(seed), unit_(width / kPaintedWidthTan), image_(height, width, CV_8UC3) {}

  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  // Pixels a unit.
  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] cv::Mat& image() { return image_; }
  // Height of a row of pixels.
  [[nodiscard]] double RowPlace(int row) const { return (row - image_.rows / 2.0) / unit_; }

  // A corner for Fill.
  [[nodiscard]] cv::Point Fixed(double x, double y) const;
  void Fill(std::initializer_list<cv::Point> corners, const StreetColor& color);
  void Box(double left, double top, double right, double bottom, const StreetColor& color);
  void Disc(double x, double y, double radius, const StreetColor& color);

  // Smooth noise in about -1..1, of the picture's size: random numbers on a lattice of
  // `cells_per_unit`, cubic in between.
  [[nodiscard]] cv::Mat SmoothNoise(double cells_per_unit, std::uint64_t stream) const;

 private:
  std::uint64_t seed_;
  double unit_;
  cv::Mat image_;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_STREET_STREET_CANVAS_H_
