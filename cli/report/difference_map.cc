// SPDX-License-Identifier: Apache-2.0
#include "cli/report/difference_map.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "stabilizer/metrics/camera_residual.h"
#include "stabilizer/metrics/frame_alignment_detail.h"

namespace rsstab::report {
namespace {

// Noise of single pixels says nothing about where things lie.
constexpr int kSmoothing = 3;
const cv::Scalar kNotCompared(120, 120, 120);

cv::Mat Wrap(const FrameView& rgb) {
  return {rgb.height, rgb.width, CV_8UC3, const_cast<std::uint8_t*>(rgb.planes[0].data),
          static_cast<std::size_t>(rgb.planes[0].stride)};
}

Status CheckPicture(const FrameView& frame) {
  if (frame.layout.bit_depth != 8 || frame.layout.channels[0] != 3 || frame.width < 1 ||
      frame.planes[0].data == nullptr) {
    return Fail(ErrorCode::kInvalidArgument, "only packed 8-bit RGB pictures are compared");
  }
  return {};
}

cv::Mat Luma(const cv::Mat& rgb) {
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

Result<Frame> ToFrame(const cv::Mat& bgr, const PixelLayout& layout) {
  auto frame = AllocateFrame(layout, bgr.cols, bgr.rows);
  if (frame) {
    const MutablePlaneView& plane = frame->planes[0];
    cv::Mat out(bgr.rows, bgr.cols, CV_8UC3, plane.data, static_cast<std::size_t>(plane.stride));
    cv::cvtColor(bgr, out, cv::COLOR_BGR2RGB);
  }
  return frame;
}

cv::Mat Colored(const cv::Mat& difference) {
  cv::Mat level;
  difference.convertTo(level, CV_8U, 255.0 / kFullDifference);
  cv::Mat colors;
  cv::applyColorMap(level, colors, cv::COLORMAP_INFERNO);
  return colors;
}

// `valid`: 0 where nothing can be compared, else empty.
Result<Frame> Map(const cv::Mat& picture, const cv::Mat& truth, const cv::Mat& valid,
                  const PixelLayout& layout) {
  cv::Mat difference;
  cv::absdiff(Luma(picture), Luma(truth), difference);
  cv::blur(difference, difference, {kSmoothing, kSmoothing});
  cv::Mat colors = Colored(difference);
  if (!valid.empty()) {
    colors.setTo(kNotCompared, valid == 0);
  }
  return ToFrame(colors, layout);
}

// Where each pixel of the picture looks in the truth; far outside where it does not.
cv::Mat SourceMap(const stabilizer::RotationZoom& fit, const Camera& picture, const Camera& truth) {
  const CameraProjector from(picture);
  const CameraProjector to(truth);
  const Eigen::Matrix3d rotation = fit.to_from_from.toRotationMatrix();
  cv::Mat map(picture.height, picture.width, CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      cv::Vec2f& source = map.at<cv::Vec2f>(y, x);
      source = {-10.0F, -10.0F};
      const auto ray = from.UnprojectPixel(Eigen::Vector2d(x, y));
      if (!ray || ray->z() <= 0.0) {
        continue;
      }
      const Eigen::Vector2d ideal = fit.zoom * ray->hnormalized();
      if (const auto pixel = to.ProjectRay(rotation * ideal.homogeneous())) {
        source = {static_cast<float>(pixel->x()), static_cast<float>(pixel->y())};
      }
    }
  }
  return map;
}

}  // namespace

Result<Frame> DifferenceMap(const FrameView& picture, const FrameView& truth,
                            std::span<const std::uint8_t> valid) {
  for (const FrameView& frame : {picture, truth}) {
    if (Status status = CheckPicture(frame); !status) {
      return Propagate(status.error());
    }
  }
  const auto pixels =
      static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (picture.width != truth.width || picture.height != truth.height ||
      (!valid.empty() && valid.size() != pixels)) {
    return Fail(ErrorCode::kInvalidArgument,
                "a picture of {}x{} is not compared with one of {}x{} and {} marks", picture.width,
                picture.height, truth.width, truth.height, valid.size());
  }
  cv::Mat marks;
  if (!valid.empty()) {
    marks.create(picture.height, picture.width, CV_8U);
    std::memcpy(marks.data, valid.data(), valid.size());
  }
  return Map(Wrap(picture), Wrap(truth), marks, picture.layout);
}

Result<std::optional<Frame>> AlignedDifferenceMap(const FrameView& picture, const FrameView& truth,
                                                  const Camera& camera) {
  for (const FrameView& frame : {picture, truth}) {
    if (Status status = CheckPicture(frame); !status) {
      return Propagate(status.error());
    }
  }
  const cv::Mat from = Wrap(picture);
  const cv::Mat to = Wrap(truth);
  const auto alignment = stabilizer::detail::AlignFrames(Luma(from), Luma(to));
  if (!alignment) {
    return std::nullopt;
  }
  const Camera from_camera = camera.Rescaled(from.cols, from.rows);
  const Camera to_camera = camera.Rescaled(to.cols, to.rows);
  const auto fit = stabilizer::FitRotationZoom(alignment->matches, from_camera, to_camera);
  if (!fit) {
    return std::nullopt;
  }
  const cv::Mat map = SourceMap(*fit, from_camera, to_camera);
  cv::Mat brought;
  cv::remap(to, brought, map, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  std::vector<cv::Mat> xy;
  cv::split(map, xy);
  const cv::Mat valid =
      (xy[0] >= 0) & (xy[1] >= 0) & (xy[0] <= to.cols - 1) & (xy[1] <= to.rows - 1);
  auto result = Map(from, brought, valid, picture.layout);
  if (!result) {
    return Propagate(result.error());
  }
  return std::move(*result);
}

Result<Frame> DifferenceKey() {
  cv::Mat levels(1, kFullDifference + 1, CV_8U);
  for (int x = 0; x < levels.cols; ++x) {
    levels.at<std::uint8_t>(0, x) = static_cast<std::uint8_t>(x);
  }
  PixelLayout layout;
  layout.num_planes = 1;
  layout.channels[0] = 3;
  layout.is_rgb = true;
  return ToFrame(Colored(levels), layout);
}

}  // namespace rsstab::report
