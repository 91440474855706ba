// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/image_metrics.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "stabilizer/metrics/luma_detail.h"

namespace rsstab::stabilizer {
namespace {

constexpr int kWindow = 11;
constexpr double kWindowSigma = 1.5;

struct Pair {
  cv::Mat a;
  cv::Mat b;
  cv::Mat valid;  // 8 bit, 0 or 255
};

Result<Pair> Prepare(const FrameView& a, const FrameView& b, PixelMask valid) {
  if (a.width != b.width || a.height != b.height || a.layout.bit_depth != b.layout.bit_depth) {
    return Fail(ErrorCode::kInvalidArgument,
                "Pictures of {}x{} ({} bit) and {}x{} ({} bit) cannot be compared pixel by pixel.",
                a.width, a.height, a.layout.bit_depth, b.width, b.height, b.layout.bit_depth);
  }
  auto luma_a = detail::NativeLuma(a);
  if (!luma_a) {
    return Propagate(luma_a.error());
  }
  auto luma_b = detail::NativeLuma(b);
  if (!luma_b) {
    return Propagate(luma_b.error());
  }
  Pair pair{*luma_a, *luma_b, cv::Mat(a.height, a.width, CV_8U, cv::Scalar(255))};
  if (!valid.empty()) {
    if (valid.size() != pair.valid.total()) {
      return Fail(ErrorCode::kInvalidArgument, "A mask of {} pixels does not fit {}x{} pictures.",
                  valid.size(), a.width, a.height);
    }
    std::transform(valid.begin(), valid.end(), pair.valid.begin<std::uint8_t>(),
                   [](std::uint8_t v) { return static_cast<std::uint8_t>(v != 0 ? 255 : 0); });
  }
  if (cv::countNonZero(pair.valid) == 0) {
    return Fail(ErrorCode::kInvalidArgument, "No valid pixel is left to compare.");
  }
  return pair;
}

cv::Mat Blur(const cv::Mat& image) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, {kWindow, kWindow}, kWindowSigma, kWindowSigma,
                   cv::BORDER_CONSTANT);
  return blurred;
}

}  // namespace

Result<double> Psnr(const FrameView& a, const FrameView& b, PixelMask valid) {
  const auto pair = Prepare(a, b, valid);
  if (!pair) {
    return Propagate(pair.error());
  }
  const double distance = cv::norm(pair->a, pair->b, cv::NORM_L2SQR, pair->valid);
  const double mean = distance / cv::countNonZero(pair->valid);
  const double peak = static_cast<double>((1 << a.layout.bit_depth) - 1);
  if (mean <= 0.0) {
    return kLargestPsnrDb;
  }
  return std::min(kLargestPsnrDb, 10.0 * std::log10(peak * peak / mean));
}

Result<double> Ssim(const FrameView& a, const FrameView& b, PixelMask valid) {
  const auto pair = Prepare(a, b, valid);
  if (!pair) {
    return Propagate(pair.error());
  }
  cv::Mat weight;
  pair->valid.convertTo(weight, CV_64F, 1.0 / 255.0);
  cv::Mat x;
  cv::Mat y;
  pair->a.convertTo(x, CV_64F);
  pair->b.convertTo(y, CV_64F);
  // Local means over the valid pixels of a window: blur(w f) / blur(w). Outside the picture the
  // weight is 0 as well, so that border windows are renormalised, not mirrored.
  const cv::Mat total = cv::max(Blur(weight), 1e-12);
  const auto mean_of = [&](const cv::Mat& image) -> cv::Mat {
    return Blur(weight.mul(image)) / total;
  };
  const cv::Mat mean_x = mean_of(x);
  const cv::Mat mean_y = mean_of(y);
  const cv::Mat var_x = mean_of(x.mul(x)) - mean_x.mul(mean_x);
  const cv::Mat var_y = mean_of(y.mul(y)) - mean_y.mul(mean_y);
  const cv::Mat cov = mean_of(x.mul(y)) - mean_x.mul(mean_y);
  const double peak = static_cast<double>((1 << a.layout.bit_depth) - 1);
  const double c1 = (0.01 * peak) * (0.01 * peak);
  const double c2 = (0.03 * peak) * (0.03 * peak);
  const cv::Mat numerator = (2.0 * mean_x.mul(mean_y) + c1).mul(2.0 * cov + c2);
  const cv::Mat denominator =
      (mean_x.mul(mean_x) + mean_y.mul(mean_y) + c1).mul(var_x + var_y + c2);
  return cv::mean(numerator / denominator, pair->valid)[0];
}

Result<double> BlockSsim(const FrameView& a, const FrameView& b, PixelMask valid) {
  constexpr int kSide = 8;
  constexpr int kStep = 4;
  constexpr double kPixels = kSide * kSide;
  const auto pair = Prepare(a, b, valid);
  if (!pair) {
    return Propagate(pair.error());
  }
  cv::Mat x;
  cv::Mat y;
  pair->a.convertTo(x, CV_64F);
  pair->b.convertTo(y, CV_64F);
  const double peak = static_cast<double>((1 << a.layout.bit_depth) - 1);
  const double c1 = (0.01 * peak) * (0.01 * peak);
  const double c2 = (0.03 * peak) * (0.03 * peak);
  double sum = 0.0;
  int windows = 0;
  for (int top = 0; top + kSide <= x.rows; top += kStep) {
    for (int left = 0; left + kSide <= x.cols; left += kStep) {
      const cv::Rect window(left, top, kSide, kSide);
      if (cv::countNonZero(pair->valid(window)) < kSide * kSide) {
        continue;
      }
      const cv::Mat wx = x(window);
      const cv::Mat wy = y(window);
      const double mean_x = cv::sum(wx)[0] / kPixels;
      const double mean_y = cv::sum(wy)[0] / kPixels;
      const double scale = 1.0 / (kPixels - 1.0);
      const double var_x = (wx.dot(wx) - kPixels * mean_x * mean_x) * scale;
      const double var_y = (wy.dot(wy) - kPixels * mean_y * mean_y) * scale;
      const double cov = (wx.dot(wy) - kPixels * mean_x * mean_y) * scale;
      sum += (2.0 * mean_x * mean_y + c1) * (2.0 * cov + c2) /
             ((mean_x * mean_x + mean_y * mean_y + c1) * (var_x + var_y + c2));
      ++windows;
    }
  }
  if (windows == 0) {
    return Fail(ErrorCode::kInvalidArgument, "No window of 8x8 valid pixels is left to compare.");
  }
  return sum / windows;
}

}  // namespace rsstab::stabilizer
