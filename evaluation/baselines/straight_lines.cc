// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/straight_lines.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "evaluation/baselines/manhattan_motion.h"
#include "evaluation/field_reference.h"
#include "igf/base/readout_motion.h"
#include "stabilizer/luma_proxy.h"

namespace rsstab::evaluation {
namespace {

// Shorter pieces say little of a direction.
constexpr double kLeastLength = 0.03;  // of the width
constexpr std::size_t kMostSegments = 400;

// The longest segments of the picture, in its pixels.
Result<std::vector<EdgeSegment>> FindSegments(const FrameView& picture) {
  const auto luma = stabilizer::MakeLumaProxy(picture);
  if (!luma) {
    return Propagate(luma.error());
  }
  std::vector<cv::Vec4f> lines;
  try {
    const cv::Mat gray(luma->height, luma->width, CV_8U,
                       const_cast<std::uint8_t*>(luma->pixels.data()));  // only read
    // A bent edge comes as several segments, each straight to within a pixel.
    cv::createLineSegmentDetector(cv::LSD_REFINE_STD)->detect(gray, lines);
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kInternal, "finding line segments failed: {}", error.err);
  }
  const Eigen::Vector2d scale(static_cast<double>(picture.width) / luma->width,
                              static_cast<double>(picture.height) / luma->height);
  // A size change scales x + 0.5.
  const auto at = [&](float x, float y) -> Eigen::Vector2d {
    return (Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y)).array() + 0.5) *
               scale.array() -
           0.5;
  };
  std::vector<EdgeSegment> segments;
  for (const cv::Vec4f& line : lines) {
    const EdgeSegment segment{at(line[0], line[1]), at(line[2], line[3])};
    if (segment.Length() >= kLeastLength * picture.width) {
      segments.push_back(segment);
    }
  }
  std::stable_sort(
      segments.begin(), segments.end(),
      [](const EdgeSegment& a, const EdgeSegment& b) { return a.Length() > b.Length(); });
  segments.resize(std::min(segments.size(), kMostSegments));
  return segments;
}

}  // namespace

Result<MethodAnswer> StraightLinesMethod::Estimate(const MethodInput& input) {
  const double focal_px =
      know_focal_ && input.camera != nullptr ? input.camera->fx : input.rs.width;
  const Camera camera = Camera::Pinhole(input.rs.width, input.rs.height, focal_px);
  const auto segments = FindSegments(input.rs);
  if (!segments) {
    return Propagate(segments.error());
  }
  const auto motion = FitManhattanMotion(*segments, camera, input.seed);
  if (!motion) {
    return Propagate(motion.error());
  }
  std::vector<Eigen::Quaterniond> rotations;
  const int knots = ReadoutMotion::KnotCount(camera.height);
  for (int i = 0; i < knots; ++i) {
    rotations.push_back(motion->AtRow((camera.height - 1.0) * i / (knots - 1), camera.height));
  }
  auto field = FieldFromRow(camera, rotations, input.ReferenceRow());
  if (!field) {
    return Propagate(field.error());
  }
  return MethodAnswer{std::move(*field), {}};
}

}  // namespace rsstab::evaluation
