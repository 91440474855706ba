// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/pair_metrics.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include "igf/base/homography.h"
#include "stabilizer/metrics/frame_alignment_detail.h"
#include "stabilizer/metrics/luma_detail.h"
#include "stabilizer/metrics/path_metrics.h"

namespace rsstab::stabilizer {
namespace {

constexpr std::size_t kFewestForDistortion = 40;
// A homography fitted to tracks is good to a few tenths of a pixel in the corners, and only near
// the truth where the output is no homography of the input (rolling shutter corrected, mesh): so
// many times its root mean square residual is tolerated on top.
constexpr double kOutsidePx = 1.0;
constexpr double kOutsideResiduals = 3.0;
constexpr double kLargestResidualPx = 8.0;
// In 8-bit levels: how dark an invented border is, with coding noise, and how much brighter the
// input must be to say that it was not dark by itself.
constexpr int kBlackSlack = 4;
constexpr int kBrighter = 16;

// The homography in coordinates whose origin is the picture's centre and whose unit is one pixel at
// reference width.
Eigen::Matrix3d FromPicture(const cv::Mat& picture) {
  const double scale = detail::ToReference(picture.cols);
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(0, 0) = matrix(1, 1) = scale;
  matrix(0, 2) = -0.5 * (picture.cols - 1) * scale;
  matrix(1, 2) = -0.5 * (picture.rows - 1) * scale;
  return matrix;
}

Eigen::Matrix3d Centred(const Eigen::Matrix3d& in_from_out, const cv::Mat& in, const cv::Mat& out) {
  const Eigen::Matrix3d centred = FromPicture(in) * in_from_out * FromPicture(out).inverse();
  return centred / centred(2, 2);
}

// Black of the frame's range as it appears in the 8-bit picture.
int BlackOf(const FrameView& frame) {
  return frame.layout.BlackLevel(0, 0) >> (frame.layout.bit_depth - 8);
}

cv::Mat BlackBorders(const cv::Mat& out, const cv::Mat& source, int black) {
  const cv::Mat dark = out <= black + kBlackSlack;
  const cv::Mat brighter = source >= black + kBlackSlack + kBrighter;
  cv::Mat labels;
  const int count = cv::connectedComponents(dark, labels, 4, CV_32S);
  std::vector<std::uint8_t> touches(static_cast<std::size_t>(count), 0);
  for (int x = 0; x < out.cols; ++x) {
    touches[static_cast<std::size_t>(labels.at<int>(0, x))] = 1;
    touches[static_cast<std::size_t>(labels.at<int>(out.rows - 1, x))] = 1;
  }
  for (int y = 0; y < out.rows; ++y) {
    touches[static_cast<std::size_t>(labels.at<int>(y, 0))] = 1;
    touches[static_cast<std::size_t>(labels.at<int>(y, out.cols - 1))] = 1;
  }
  touches[0] = 0;  // not dark
  cv::Mat borders = cv::Mat::zeros(out.size(), CV_8U);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      if (touches[static_cast<std::size_t>(labels.at<int>(y, x))] != 0 &&
          brighter.at<std::uint8_t>(y, x) != 0) {
        borders.at<std::uint8_t>(y, x) = 255;
      }
    }
  }
  return borders;
}

// Pixels of the input's picture.
double RmsResidual(const detail::FrameAlignment& alignment, double largest) {
  double squares = 0.0;
  double count = 1e-9;
  for (const PointMatch& match : alignment.matches) {
    const auto expected = ProjectChecked(alignment.second_from_first, match.from.cast<double>());
    const double length = expected ? (match.to.cast<double>() - *expected).norm() : largest + 1.0;
    if (length < largest) {
      squares += length * length;
      count += 1.0;
    }
  }
  return std::sqrt(squares / count);
}

double UndefinedShare(const cv::Mat& in, const cv::Mat& out,
                      const detail::FrameAlignment& alignment, int black) {
  const Eigen::Matrix3d& in_from_out = alignment.second_from_first;
  cv::Mat map;
  cv::eigen2cv(in_from_out, map);
  cv::Mat source;  // outside the input: bright, so that black there counts
  cv::warpPerspective(in, source, map, out.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                      cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::Mat undefined = BlackBorders(out, source, black);
  const double pixel = 1.0 / detail::ToReference(in.cols);
  const double slack = 0.5 + kOutsidePx * pixel +
                       kOutsideResiduals * RmsResidual(alignment, kLargestResidualPx * pixel);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      const auto there = ProjectChecked(in_from_out, {x, y});
      if (!there || there->x() < -slack || there->y() < -slack ||
          there->x() > in.cols - 1 + slack || there->y() > in.rows - 1 + slack) {
        undefined.at<std::uint8_t>(y, x) = 255;
      }
    }
  }
  return cv::countNonZero(undefined) / static_cast<double>(out.total());
}

}  // namespace

Status PairMeter::Push(const FrameView& input, const FrameView& output) {
  const auto input_luma = detail::NativeLuma(input);
  if (!input_luma) {
    return Propagate(input_luma.error());
  }
  const auto output_luma = detail::NativeLuma(output);
  if (!output_luma) {
    return Propagate(output_luma.error());
  }
  ++frames_;
  const cv::Mat in = detail::MetricPicture(*input_luma, input.layout.bit_depth);
  const cv::Mat out = detail::MetricPicture(*output_luma, output.layout.bit_depth);
  const auto alignment = detail::AlignFrames(out, in);
  if (!alignment) {
    return {};
  }
  const Eigen::Matrix3d centred = Centred(alignment->second_from_first, in, out);
  const double crop = SimilarityAt(centred, Eigen::Vector2d::Zero()).scale;
  smallest_crop_ = aligned_ == 0 ? crop : std::min(smallest_crop_, crop);
  crop_sum_ += crop;
  ++aligned_;
  if (alignment->matches.size() >= kFewestForDistortion) {
    distortion_ = std::min(distortion_, AffineAnisotropy(centred));
    ++with_distortion_;
  }
  const double undefined = UndefinedShare(in, out, *alignment, BlackOf(output));
  undefined_sum_ += undefined;
  worst_undefined_ = std::max(worst_undefined_, undefined);
  return {};
}

PairMetrics PairMeter::Measure() const {
  PairMetrics result;
  result.frames = frames_;
  result.unaligned = frames_ - aligned_;
  if (aligned_ > 0) {
    const auto count = static_cast<double>(aligned_);
    result.crop = crop_sum_ / count;
    result.smallest_crop = smallest_crop_;
    result.undefined = undefined_sum_ / count;
    result.worst_undefined = worst_undefined_;
  }
  if (with_distortion_ > 0) {
    result.distortion = distortion_;
  }
  return result;
}

}  // namespace rsstab::stabilizer
