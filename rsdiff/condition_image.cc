// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/condition_image.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rsdiff/orientation_planes.h"

namespace rsstab::rsdiff {
namespace {

// Above this many rows a YUV picture is taken for high definition.
constexpr int kStandardRows = 576;

// Red and blue weight of luma (the green one is the rest).
struct LumaWeights {
  double red;
  double blue;
};
constexpr LumaWeights kBt601{0.299, 0.114};
constexpr LumaWeights kBt709{0.2126, 0.0722};

// Wraps a plane without copying; OpenCV only reads it.
cv::Mat WrapPlane(const FrameView& image, int plane) {
  const auto index = static_cast<std::size_t>(plane);
  const PlaneView& view = image.planes[index];
  const int depth = image.layout.BytesPerSample() == 1 ? CV_8U : CV_16U;
  // cv::Mat has no const view; the header is local and never written through.
  auto* data =
      const_cast<std::uint8_t*>(view.data);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  return {view.height, view.width, CV_MAKETYPE(depth, image.layout.channels[index]), data,
          static_cast<std::size_t>(view.stride)};
}

// Shrinks by area averages and enlarges bilinearly, each side as it needs.
cv::Mat Stretch(const cv::Mat& picture, const cv::Size& size) {
  cv::Mat result = picture;
  const cv::Size shrunk(std::min(size.width, picture.cols), std::min(size.height, picture.rows));
  if (shrunk != picture.size()) {
    cv::resize(picture, result, shrunk, 0.0, 0.0, cv::INTER_AREA);
  }
  if (size != shrunk) {
    cv::Mat enlarged;
    cv::resize(result, enlarged, size, 0.0, 0.0, cv::INTER_LINEAR);
    return enlarged;
  }
  return result;
}

// Red, green and blue of an RGB picture, each of its own depth, stretched to `size`.
std::array<cv::Mat, 3> RgbChannels(const FrameView& image, const cv::Size& size) {
  if (image.layout.num_planes >= 3) {
    // libav's planar RGB has green first, then blue.
    return {Stretch(WrapPlane(image, 2), size), Stretch(WrapPlane(image, 0), size),
            Stretch(WrapPlane(image, 1), size)};
  }
  std::vector<cv::Mat> packed;
  cv::split(Stretch(WrapPlane(image, 0), size), packed);
  return {packed[0], packed[1], packed[2]};
}

bool IsRgb(const PixelLayout& layout) {
  return layout.is_rgb && (layout.num_planes >= 3 || layout.channels[0] >= 3);
}

// What takes samples of a plane to [0, 1] (chroma: to [-0.5, 0.5]): sample * scale + shift.
struct Levels {
  double scale;
  double shift;
};

Levels LevelsOf(const PixelLayout& layout, bool is_chroma) {
  const double unit = static_cast<double>(1 << (layout.bit_depth - 8));  // one 8-bit level
  const double most = static_cast<double>((1 << layout.bit_depth) - 1);
  const bool is_full = layout.is_rgb || layout.full_range;
  if (is_chroma) {
    const double scale = is_full ? 1.0 / most : 1.0 / (224.0 * unit);
    return {scale, -128.0 * unit * scale};
  }
  if (is_full) {
    return {1.0 / most, 0.0};
  }
  return {1.0 / (219.0 * unit), -16.0 / 219.0};
}

cv::Mat ToUnit(const cv::Mat& samples, const PixelLayout& layout, bool is_chroma) {
  const Levels levels = LevelsOf(layout, is_chroma);
  cv::Mat unit;
  samples.convertTo(unit, CV_32F, levels.scale, levels.shift);
  return unit;
}

// Brightness, 8 bits, full range, of the given size.
cv::Mat GrayPicture(const FrameView& image, const cv::Size& size) {
  cv::Mat luma;
  if (IsRgb(image.layout)) {
    const auto [red, green, blue] = RgbChannels(image, size);
    cv::Mat red_and_green;
    cv::addWeighted(red, kBt601.red, green, 1.0 - kBt601.red - kBt601.blue, 0.0, red_and_green,
                    CV_32F);
    cv::Mat blue_part;
    blue.convertTo(blue_part, CV_32F, kBt601.blue);
    luma = red_and_green + blue_part;
  } else {
    luma = Stretch(WrapPlane(image, 0), size);
  }
  const Levels levels = LevelsOf(image.layout, false);
  cv::Mat gray;
  luma.convertTo(gray, CV_8U, 255.0 * levels.scale, 255.0 * levels.shift);
  return gray;
}

// Red, green and blue in [0, 1], float, of the given size.
std::array<cv::Mat, 3> RgbPicture(const FrameView& image, const cv::Size& size) {
  const PixelLayout& layout = image.layout;
  if (IsRgb(layout)) {
    std::array<cv::Mat, 3> channels = RgbChannels(image, size);
    for (cv::Mat& channel : channels) {
      channel = ToUnit(channel, layout, false);
    }
    return channels;
  }
  const cv::Mat y = ToUnit(Stretch(WrapPlane(image, 0), size), layout, false);
  if (!layout.IsChroma(1)) {
    return {y, y, y};
  }
  // Stretching and the colour matrix are linear, so the small planes are combined. Where chroma
  // samples sit between luma pixels matters little at that size.
  std::array<cv::Mat, 2> chroma;
  if (layout.channels[1] == 2) {
    cv::split(Stretch(WrapPlane(image, 1), size), chroma.data());
  } else {
    chroma = {Stretch(WrapPlane(image, 1), size), Stretch(WrapPlane(image, 2), size)};
  }
  const cv::Mat cb = ToUnit(chroma[0], layout, true);
  const cv::Mat cr = ToUnit(chroma[1], layout, true);
  const LumaWeights w = image.height > kStandardRows ? kBt709 : kBt601;
  const double green = 1.0 - w.red - w.blue;
  const double cr_to_red = 2.0 * (1.0 - w.red);
  const double cb_to_blue = 2.0 * (1.0 - w.blue);
  return {cv::Mat(y + cr_to_red * cr),
          cv::Mat(y - (w.blue * cb_to_blue / green) * cb - (w.red * cr_to_red / green) * cr),
          cv::Mat(y + cb_to_blue * cb)};
}

Tensor RgbCondition(const FrameView& image, const Shape& shape) {
  Tensor condition(1, shape);
  float* out = condition.values.data();
  for (const cv::Mat& channel : RgbPicture(image, cv::Size(shape.columns, shape.rows))) {
    for (int row = 0; row < shape.rows; ++row) {
      const float* in = channel.ptr<float>(row);
      out = std::transform(in, in + shape.columns, out,
                           [](float value) { return 2.0F * std::clamp(value, 0.0F, 1.0F) - 1.0F; });
    }
  }
  return condition;
}

Result<Tensor> OrientationCondition(const FrameView& image) {
  const PictureSize size = OrientationWorkingSize(image.width, image.height);
  cv::Mat gray = GrayPicture(image, cv::Size(size.width, size.height));
  if (!gray.isContinuous()) {
    gray = gray.clone();
  }
  return OrientationPlanes(std::span(gray.ptr<std::uint8_t>(), gray.total()), size);
}

Status CheckPicture(const FrameView& image) {
  const PixelLayout& layout = image.layout;
  if (image.width < 1 || image.height < 1 || layout.num_planes < 1 ||
      layout.num_planes > kMaxPlanes || layout.bit_depth < 8 || layout.bit_depth > 16) {
    return Fail(ErrorCode::kInvalidArgument,
                "a picture of {}x{} pixels in {} planes of {} bits is not possible", image.width,
                image.height, layout.num_planes, layout.bit_depth);
  }
  for (int p = 0; p < layout.num_planes; ++p) {
    const auto index = static_cast<std::size_t>(p);
    const PlaneView& plane = image.planes[index];
    if (plane.data == nullptr || plane.width != layout.PlaneWidth(p, image.width) ||
        plane.height != layout.PlaneHeight(p, image.height)) {
      return Fail(ErrorCode::kInvalidArgument, "plane {} of a picture of {}x{} pixels is missing",
                  p, image.width, image.height);
    }
    const int channels = layout.channels[index];
    const bool is_known = channels == 1 || (channels == 2 && layout.IsChroma(p)) ||
                          (p == 0 && layout.is_rgb && (channels == 3 || channels == 4));
    if (!is_known) {
      return Fail(ErrorCode::kUnsupported,
                  "pictures with {} samples per pixel in plane {} cannot be analysed", channels, p);
    }
  }
  return {};
}

}  // namespace

Result<Tensor> MakeCondition(const FrameView& image, ConditionKind kind, const Shape& shape) {
  if (const Status valid = CheckPicture(image); !valid) {
    return Propagate(valid.error());
  }
  const Shape needed =
      kind == ConditionKind::kRgb ? Shape{3, shape.rows, shape.columns} : kOrientationShape;
  if (shape != needed || shape.Count() == 0) {
    return Fail(ErrorCode::kInvalidArgument, "a condition of {}x{}x{} is not possible",
                shape.channels, shape.rows, shape.columns);
  }
  try {
    return kind == ConditionKind::kRgb ? RgbCondition(image, shape) : OrientationCondition(image);
  } catch (const cv::Exception& e) {
    return Fail(ErrorCode::kInternal, "preparing a picture of {}x{} pixels failed: {}", image.width,
                image.height, e.what());
  }
}

}  // namespace rsstab::rsdiff
