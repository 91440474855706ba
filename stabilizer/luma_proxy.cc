// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/luma_proxy.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rsstab::stabilizer {
namespace {

constexpr int kFingerprintSide = 8;

// Wraps a plane without copying, its rows in the order of memory; OpenCV only reads it.
cv::Mat WrapPlane(const PlaneView& plane, int depth, int channels) {
  const std::ptrdiff_t lowest = plane.stride < 0 ? plane.stride * (plane.height - 1) : 0;
  // cv::Mat has no const view; the header is local and never written through.
  auto* data = const_cast<std::uint8_t*>(  // NOLINT(cppcoreguidelines-pro-type-const-cast)
      plane.data + lowest);
  return {plane.height, plane.width, CV_MAKETYPE(depth, channels), data,
          static_cast<std::size_t>(plane.stride < 0 ? -plane.stride : plane.stride)};
}

}  // namespace

ProxySize ProxySizeFor(int width, int height) {
  if (width <= kMaxProxyWidth) {
    return {width, height};
  }
  const double scale = static_cast<double>(kMaxProxyWidth) / width;
  return {kMaxProxyWidth, std::max(1, static_cast<int>(std::lround(height * scale)))};
}

Result<GrayImage> MakeLumaProxy(const FrameView& frame) {
  const int depth = frame.layout.BytesPerSample() == 1 ? CV_8U : CV_16U;
  const int channels = frame.layout.channels[0];
  if (frame.planes[0].data == nullptr || (channels != 1 && channels != 3 && channels != 4)) {
    return Fail(ErrorCode::kUnsupported, "pictures with {} samples per pixel cannot be analysed",
                channels);
  }
  // Planar RGB as libav orders it has green first, which is close enough to luma for tracking.
  const ProxySize size = ProxySizeFor(frame.width, frame.height);
  GrayImage image{size.width, size.height, {}};
  image.pixels.resize(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  cv::Mat result(size.height, size.width, CV_8U, image.pixels.data());
  try {
    cv::Mat source = WrapPlane(frame.planes[0], depth, channels);
    cv::Mat gray;
    if (channels > 1) {
      cv::cvtColor(source, gray, channels == 4 ? cv::COLOR_RGBA2GRAY : cv::COLOR_RGB2GRAY);
      source = gray;
    }
    cv::Mat small;
    if (size.width == frame.width && size.height == frame.height) {
      small = source;
    } else {
      cv::resize(source, small, result.size(), 0.0, 0.0, cv::INTER_AREA);
    }
    const double to_8_bit = 1.0 / static_cast<double>(1 << (frame.layout.bit_depth - 8));
    small.convertTo(result, CV_8U, to_8_bit);
    if (frame.planes[0].stride < 0) {
      cv::flip(result, result, 0);
    }
  } catch (const cv::Exception& e) {
    return Fail(ErrorCode::kInternal, "scaling a frame of {}x{} down failed: {}", frame.width,
                frame.height, e.what());
  }
  return image;
}

LumaFingerprint FingerprintOf(const GrayImage& image) {
  LumaFingerprint print{};
  std::size_t next = 0;
  for (int row = 0; row < kFingerprintSide; ++row) {
    const int y0 = row * image.height / kFingerprintSide;
    const int y1 = std::max(y0 + 1, (row + 1) * image.height / kFingerprintSide);
    for (int column = 0; column < kFingerprintSide; ++column) {
      const int x0 = column * image.width / kFingerprintSide;
      const int x1 = std::max(x0 + 1, (column + 1) * image.width / kFingerprintSide);
      std::int64_t sum = 0;
      for (int y = y0; y < y1; ++y) {
        const std::uint8_t* line =
            image.pixels.data() + static_cast<std::ptrdiff_t>(y) * image.width;
        for (int x = x0; x < x1; ++x) {
          sum += line[x];
        }
      }
      const std::int64_t count = static_cast<std::int64_t>(y1 - y0) * (x1 - x0);
      print[next++] = static_cast<std::uint8_t>((sum + count / 2) / count);
    }
  }
  return print;
}

double FingerprintDistance(const LumaFingerprint& a, const LumaFingerprint& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
  }
  return sum / static_cast<double>(a.size());
}

}  // namespace rsstab::stabilizer
