// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <opencv2/core/eigen.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "igf/base/homography.h"
#include "stabilizer/metrics/frame_alignment_detail.h"
#include "stabilizer/metrics/luma_detail.h"
#include "stabilizer/metrics/metric_tracks_detail.h"
#include "stabilizer/metrics/robust_homography.h"

namespace rsstab::stabilizer::detail {
namespace {

constexpr int kFeatures = 1200;
// A feature's best match must be this much nearer than its second best.
constexpr float kDistinctRatio = 0.8F;
// Coarse: features sit on pixels of a pyramid, several px wide on its upper levels.
constexpr double kCoarseScalePx = 3.0;
constexpr double kFineScalePx = 2.5;
constexpr double kBorderPx = 3.0;

std::vector<PointMatch> FeatureMatches(const cv::Mat& first, const cv::Mat& second) {
  const auto orb = cv::ORB::create(kFeatures, 1.2F, 8, 15, 0, 2, cv::ORB::HARRIS_SCORE, 31, 10);
  std::array<std::vector<cv::KeyPoint>, 2> points;
  std::array<cv::Mat, 2> descriptors;
  orb->detectAndCompute(first, cv::noArray(), points[0], descriptors[0]);
  orb->detectAndCompute(second, cv::noArray(), points[1], descriptors[1]);
  std::vector<PointMatch> matches;
  if (descriptors[0].rows < 2 || descriptors[1].rows < 2) {
    return matches;
  }
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(descriptors[0], descriptors[1], nearest, 2);
  for (const auto& pair : nearest) {
    if (pair.size() == 2 && pair[0].distance < kDistinctRatio * pair[1].distance) {
      const cv::Point2f& from = points[0][static_cast<std::size_t>(pair[0].queryIdx)].pt;
      const cv::Point2f& to = points[1][static_cast<std::size_t>(pair[0].trainIdx)].pt;
      matches.push_back({{from.x, from.y}, {to.x, to.y}});
    }
  }
  return matches;
}

std::vector<PointMatch> TrackThrough(const cv::Mat& first, const cv::Mat& second,
                                     const Eigen::Matrix3d& second_from_first) {
  cv::Mat map;
  cv::eigen2cv(second_from_first, map);
  cv::Mat warped;
  cv::warpPerspective(second, warped, map, first.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                      cv::BORDER_REPLICATE);
  std::vector<PointMatch> matches;
  for (const PointMatch& track : MetricTracks(first, warped)) {
    const auto there = ProjectChecked(second_from_first, track.to.cast<double>());
    if (there && there->x() > kBorderPx && there->y() > kBorderPx &&
        there->x() < second.cols - 1 - kBorderPx && there->y() < second.rows - 1 - kBorderPx) {
      matches.push_back({track.from, there->cast<float>()});
    }
  }
  return matches;
}

}  // namespace

std::optional<FrameAlignment> AlignFrames(const cv::Mat& first, const cv::Mat& second) {
  const double pixel = 1.0 / ToReference(first.cols);
  auto coarse = RobustHomography(FeatureMatches(first, second), kCoarseScalePx * pixel);
  if (!coarse && first.size() == second.size()) {
    // Too little structure for features; the pictures may still be near each other.
    coarse = Eigen::Matrix3d::Identity();
  }
  if (!coarse) {
    return std::nullopt;
  }
  FrameAlignment result;
  result.matches = TrackThrough(first, second, *coarse);
  const auto fine = RobustHomography(result.matches, kFineScalePx * pixel);
  if (!fine) {
    return std::nullopt;
  }
  result.second_from_first = *fine;
  return result;
}

}  // namespace rsstab::stabilizer::detail
