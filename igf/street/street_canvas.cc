// SPDX-License-Identifier: Apache-2.0
#include "igf/street/street_canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "igf/base/seeded_random.h"

namespace rsstab::igf {
namespace {

// Sub-pixel bits of OpenCV's drawing functions.
constexpr int kShift = 4;

cv::Scalar Ink(const StreetColor& color) { return {color[0], color[1], color[2]}; }

}  // namespace

cv::Point StreetCanvas::Fixed(double x, double y) const {
  const double pixel_x = (x - kStreetLeft) * unit_ - 0.5;
  const double pixel_y = y * unit_ + image_.rows / 2.0 - 0.5;
  return {static_cast<int>(std::lround(pixel_x * (1 << kShift))),
          static_cast<int>(std::lround(pixel_y * (1 << kShift)))};
}

void StreetCanvas::Fill(std::initializer_list<cv::Point> corners, const StreetColor& color) {
  cv::fillConvexPoly(image_, std::vector<cv::Point>(corners), Ink(color), cv::LINE_AA, kShift);
}

void StreetCanvas::Box(double left, double top, double right, double bottom,
                       const StreetColor& color) {
  Fill({Fixed(left, top), Fixed(right, top), Fixed(right, bottom), Fixed(left, bottom)}, color);
}

void StreetCanvas::Disc(double x, double y, double radius, const StreetColor& color) {
  cv::circle(image_, Fixed(x, y), static_cast<int>(std::lround(radius * unit_ * (1 << kShift))),
             Ink(color), cv::FILLED, cv::LINE_AA, kShift);
}

cv::Mat StreetCanvas::SmoothNoise(double cells_per_unit, std::uint64_t stream) const {
  const auto cells = [&](int pixels) {
    return std::max(2, static_cast<int>(std::lround(cells_per_unit * pixels / unit_)));
  };
  const int columns = cells(image_.cols);
  const int rows = cells(image_.rows);
  cv::Mat lattice(rows, columns, CV_32F);
  SeededRandom random(seed_, stream);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      lattice.at<float>(y, x) = static_cast<float>(random.Uniform(-1.0, 1.0));
    }
  }
  cv::Mat noise;
  cv::resize(lattice, noise, image_.size(), 0.0, 0.0, cv::INTER_CUBIC);
  return noise;
}

}  // namespace rsstab::igf
