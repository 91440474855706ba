// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "stabilizer/metrics/luma_detail.h"

namespace rsstab::stabilizer::detail {
namespace {

// Wraps a plane without copying; nobody writes through it.
cv::Mat WrapPlane(const PlaneView& plane, int depth, int channels) {
  return {plane.height, plane.width, CV_MAKETYPE(depth, channels),
          const_cast<std::uint8_t*>(plane.data), static_cast<std::size_t>(plane.stride)};
}

}  // namespace

Result<cv::Mat> NativeLuma(const FrameView& frame) {
  const PixelLayout& layout = frame.layout;
  if (frame.width < 1 || frame.height < 1 || frame.planes[0].data == nullptr) {
    return Fail(ErrorCode::kInvalidArgument, "A frame to be measured has no samples.");
  }
  const int depth = layout.BytesPerSample() == 1 ? CV_8U : CV_16U;
  const int first_channels = layout.channels[0];
  if (!layout.is_rgb) {
    cv::Mat luma = WrapPlane(frame.planes[0], depth, first_channels);
    if (first_channels == 1) {
      return luma;
    }
    cv::Mat first;
    cv::extractChannel(luma, first, 0);
    return first;
  }
  std::vector<cv::Mat> colours;
  if (first_channels >= 3) {
    cv::split(WrapPlane(frame.planes[0], depth, first_channels), colours);
  } else {
    for (int plane = 0; plane < std::min(layout.num_planes, 3); ++plane) {
      colours.push_back(WrapPlane(frame.planes[static_cast<std::size_t>(plane)], depth, 1));
    }
  }
  if (colours.size() < 3) {
    return colours[0].clone();
  }
  cv::Mat sum;
  cv::add(colours[0], colours[1], sum, cv::noArray(), CV_32F);
  cv::add(sum, colours[2], sum, cv::noArray(), CV_32F);
  cv::Mat mean;
  sum.convertTo(mean, depth, 1.0 / 3.0);
  return mean;
}

cv::Mat MetricPicture(const cv::Mat& native_luma, int bit_depth) {
  cv::Mat eight_bit = native_luma;
  if (bit_depth > 8) {
    native_luma.convertTo(eight_bit, CV_8U, 1.0 / static_cast<double>(1 << (bit_depth - 8)));
  }
  if (native_luma.cols <= static_cast<int>(kReferenceWidth)) {
    return eight_bit.clone();
  }
  const double scale = kReferenceWidth / native_luma.cols;
  const int height = std::max(1, static_cast<int>(std::lround(native_luma.rows * scale)));
  cv::Mat small;
  cv::resize(eight_bit, small, {static_cast<int>(kReferenceWidth), height}, 0.0, 0.0,
             cv::INTER_AREA);
  return small;
}

}  // namespace rsstab::stabilizer::detail
