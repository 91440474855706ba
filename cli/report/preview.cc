// SPDX-License-Identifier: Apache-2.0
#include "cli/report/preview.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "cli/report/base64.h"

namespace rsstab::report {
namespace {

constexpr int kWebpQuality = 78;

PixelLayout RgbLayout() {
  PixelLayout layout;
  layout.num_planes = 1;
  layout.channels[0] = 3;
  layout.is_rgb = true;
  layout.full_range = true;
  return layout;
}

// Shares the samples; nobody writes through it.
cv::Mat Wrap(const PlaneView& plane, int channels, int depth) {
  return {plane.height, plane.width, CV_MAKETYPE(depth, channels),
          const_cast<std::uint8_t*>(plane.data), static_cast<std::size_t>(plane.stride)};
}

// One plane at the preview's size, samples as floats in [0, 1] of the whole code range.
cv::Mat Shrunk(const FrameView& frame, std::size_t plane, const cv::Size& size) {
  const PixelLayout& layout = frame.layout;
  const int depth = layout.BytesPerSample() == 1 ? CV_8U : CV_16U;
  cv::Mat small;
  cv::resize(Wrap(frame.planes[plane], layout.channels[plane], depth), small, size, 0, 0,
             cv::INTER_AREA);
  small.convertTo(small, CV_32F, 1.0 / ((1 << layout.bit_depth) - 1));
  return small;
}

// All samples of a pixel, in the order of the planes: Y Cb Cr, or R G B.
std::vector<cv::Mat> Components(const FrameView& frame, const cv::Size& size) {
  std::vector<cv::Mat> components;
  for (int plane = 0; plane < frame.layout.num_planes; ++plane) {
    std::vector<cv::Mat> split;
    cv::split(Shrunk(frame, static_cast<std::size_t>(plane), size), split);
    components.insert(components.end(), split.begin(), split.end());
  }
  return components;
}

struct LumaWeights {
  double red;
  double blue;
};

LumaWeights WeightsOf(ColorMatrix matrix) {
  switch (matrix) {
    case ColorMatrix::kBt601:
      return {0.299, 0.114};
    case ColorMatrix::kBt709:
      return {0.2126, 0.0722};
    case ColorMatrix::kBt2020:
      return {0.2627, 0.0593};
  }
  return {0.2126, 0.0722};
}

// Y Cb Cr as coded -> R G B in [0, 1], in place.
void ToRgb(const PixelLayout& layout, ColorMatrix matrix, std::vector<cv::Mat>& components) {
  const double codes = (1 << layout.bit_depth) - 1;
  const double unit = 1 << (layout.bit_depth - 8);
  const double black = layout.full_range ? 0.0 : 16.0 * unit / codes;
  const double luma_span = layout.full_range ? 1.0 : 219.0 * unit / codes;
  const double chroma_span = layout.full_range ? 1.0 : 224.0 * unit / codes;
  const double middle = 128.0 * unit / codes;
  const auto [red, blue] = WeightsOf(matrix);
  const double green = 1.0 - red - blue;
  const cv::Mat y = (components[0] - black) / luma_span;
  const cv::Mat cb = (components[1] - middle) / chroma_span;
  const cv::Mat cr = (components[2] - middle) / chroma_span;
  components[0] = y + 2.0 * (1.0 - red) * cr;
  components[2] = y + 2.0 * (1.0 - blue) * cb;
  components[1] = (y - red * components[0] - blue * components[2]) / green;
}

}  // namespace

ColorMatrix ColorMatrixOf(std::string_view name, int height) {
  constexpr int kHighDefinition = 720;
  if (name == "bt709") {
    return ColorMatrix::kBt709;
  }
  if (name.starts_with("bt2020")) {
    return ColorMatrix::kBt2020;
  }
  if (name == "smpte170m" || name == "bt470bg" || name == "fcc") {
    return ColorMatrix::kBt601;
  }
  return height >= kHighDefinition ? ColorMatrix::kBt709 : ColorMatrix::kBt601;
}

Result<Frame> MakePreview(const FrameView& frame, int max_width, ColorMatrix matrix) {
  if (frame.width < 1 || frame.height < 1 || frame.planes[0].data == nullptr || max_width < 1) {
    return Fail(ErrorCode::kInvalidArgument, "a preview needs a frame with samples and a width");
  }
  const int width = std::min(frame.width, max_width);
  const int height = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(frame.height) * width / frame.width)));
  auto preview = AllocateFrame(RgbLayout(), width, height);
  if (!preview) {
    return preview;
  }
  std::vector<cv::Mat> components = Components(frame, {width, height});
  if (components.size() < 3) {  // grey
    components.resize(1);
    if (!frame.layout.is_rgb && !frame.layout.full_range) {
      const double codes = (1 << frame.layout.bit_depth) - 1;
      const double unit = 1 << (frame.layout.bit_depth - 8);
      components[0] = (components[0] - 16.0 * unit / codes) * (codes / (219.0 * unit));
    }
    components.resize(3, components[0]);
  } else {
    components.resize(3);  // without alpha
    if (!frame.layout.is_rgb) {
      ToRgb(frame.layout, matrix, components);
    }
  }
  cv::Mat rgb;
  cv::merge(components, rgb);
  const MutablePlaneView& plane = preview->planes[0];
  cv::Mat out(height, width, CV_8UC3, plane.data, static_cast<std::size_t>(plane.stride));
  rgb.convertTo(out, CV_8U, 255.0);
  return preview;
}

Result<std::string> DataUri(const FrameView& rgb, PictureFormat format, int quarter_turns) {
  if (rgb.layout.bit_depth != 8 || rgb.layout.channels[0] != 3 || rgb.planes[0].data == nullptr) {
    return Fail(ErrorCode::kInvalidArgument, "only packed 8-bit RGB goes into a page");
  }
  cv::Mat picture;
  cv::cvtColor(Wrap(rgb.planes[0], 3, CV_8U), picture, cv::COLOR_RGB2BGR);
  switch (((quarter_turns % 4) + 4) % 4) {
    case 1:
      cv::rotate(picture, picture, cv::ROTATE_90_COUNTERCLOCKWISE);
      break;
    case 2:
      cv::rotate(picture, picture, cv::ROTATE_180);
      break;
    case 3:
      cv::rotate(picture, picture, cv::ROTATE_90_CLOCKWISE);
      break;
    default:
      break;
  }
  const bool is_webp = format == PictureFormat::kWebp;
  std::vector<std::uint8_t> bytes;
  try {
    if (!cv::imencode(is_webp ? ".webp" : ".png", picture, bytes,
                      is_webp ? std::vector<int>{cv::IMWRITE_WEBP_QUALITY, kWebpQuality}
                              : std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 9})) {
      return Fail(ErrorCode::kInternal, "a picture of the report could not be encoded");
    }
  } catch (const cv::Exception& exception) {
    return Fail(ErrorCode::kInternal, "a picture of the report could not be encoded: {}",
                exception.what());
  }
  return (is_webp ? "data:image/webp;base64," : "data:image/png;base64,") + Base64(bytes);
}

}  // namespace rsstab::report
