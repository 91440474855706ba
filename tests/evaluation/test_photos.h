// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_EVALUATION_TEST_PHOTOS_H_
#define RSSTAB_TESTS_EVALUATION_TEST_PHOTOS_H_

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "evaluation/photo.h"
#include "igf/base/frame.h"

namespace rsstab::testing {

// A photo whose three channels all have the value level(x, y), rounded.
inline Frame MakePhoto(int width, int height, const std::function<double(int x, int y)>& level) {
  Frame photo = AllocateFrame(evaluation::RgbLayout(), width, height).value();
  for (int y = 0; y < height; ++y) {
    std::uint8_t* row = photo.planes[0].data + y * photo.planes[0].stride;
    for (int i = 0; i < 3 * width; ++i) {
      row[i] = static_cast<std::uint8_t>(std::lround(level(i / 3, y)));
    }
  }
  return photo;
}

// Smooth, with structure in all directions; `phase` tells photos apart.
inline double Waves(double x, double y, double phase = 0.0) {
  return 128.0 + 35.0 * std::sin(0.21 * x + 0.05 * y + phase) +
         35.0 * std::sin(0.17 * y - 0.08 * x) + 25.0 * std::cos(0.03 * x + 0.04 * y + phase);
}

// Packed RGB, one channel of a pixel.
inline int LevelAt(const Frame& picture, int x, int y, int channel = 0) {
  return picture.planes[0].data[y * picture.planes[0].stride + 3 * x + channel];
}

inline void WritePhoto(const std::filesystem::path& path, const Frame& photo) {
  const cv::Mat rgb(photo.height, photo.width, CV_8UC3, photo.planes[0].data,
                    static_cast<std::size_t>(photo.planes[0].stride));
  // All channels are alike, so their order does not matter.
  cv::imwrite(path.string(), rgb);
}

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_EVALUATION_TEST_PHOTOS_H_
