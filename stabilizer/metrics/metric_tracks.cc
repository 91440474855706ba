// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "stabilizer/metrics/luma_detail.h"
#include "stabilizer/metrics/metric_tracks_detail.h"

namespace rsstab::stabilizer::detail {
namespace {

constexpr double kCellPx = 20.0;
constexpr double kBorderPx = 10.0;
constexpr double kRoundTripPx = 0.3;
constexpr double kQuality = 0.02;
constexpr int kWindow = 15;
constexpr int kTopLevel = 3;
// Smallest cell and border in real pixels, for pictures much narrower than the reference.
constexpr int kSmallestPx = 4;

int InPicture(double reference_px, int picture_width) {
  return std::max(kSmallestPx,
                  static_cast<int>(std::lround(reference_px / ToReference(picture_width))));
}

std::vector<cv::Point2f> BestCorners(const cv::Mat& picture) {
  const int cell = InPicture(kCellPx, picture.cols);
  const int border = InPicture(kBorderPx, picture.cols);
  std::vector<cv::Point2f> corners;
  if (picture.cols <= 2 * border || picture.rows <= 2 * border) {
    return corners;
  }
  cv::Mat strength;
  cv::cornerMinEigenVal(picture, strength, 3);
  double strongest = 0.0;
  cv::minMaxLoc(strength, nullptr, &strongest);
  const double weakest = std::max(kQuality * strongest, 1e-12);
  const cv::Rect inside(border, border, picture.cols - 2 * border, picture.rows - 2 * border);
  for (int y = 0; y + cell <= picture.rows; y += cell) {
    for (int x = 0; x + cell <= picture.cols; x += cell) {
      const cv::Rect part = cv::Rect(x, y, cell, cell) & inside;
      if (part.empty()) {
        continue;
      }
      double best = 0.0;
      cv::Point where;
      cv::minMaxLoc(strength(part), nullptr, &best, nullptr, &where);
      if (best > weakest) {
        corners.emplace_back(static_cast<float>(part.x + where.x),
                             static_cast<float>(part.y + where.y));
      }
    }
  }
  return corners;
}

}  // namespace

std::vector<PointMatch> MetricTracks(const cv::Mat& from, const cv::Mat& to) {
  std::vector<PointMatch> matches;
  const std::vector<cv::Point2f> corners = BestCorners(from);
  if (corners.empty() || from.size() != to.size()) {
    return matches;
  }
  const cv::Size window(kWindow, kWindow);
  const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01);
  std::vector<cv::Mat> from_pyramid;
  std::vector<cv::Mat> to_pyramid;
  cv::buildOpticalFlowPyramid(from, from_pyramid, window, kTopLevel);
  cv::buildOpticalFlowPyramid(to, to_pyramid, window, kTopLevel);
  std::vector<cv::Point2f> there;
  std::vector<cv::Point2f> back;
  std::vector<std::uint8_t> found_there;
  std::vector<std::uint8_t> found_back;
  cv::calcOpticalFlowPyrLK(from_pyramid, to_pyramid, corners, there, found_there, cv::noArray(),
                           window, kTopLevel, stop);
  cv::calcOpticalFlowPyrLK(to_pyramid, from_pyramid, there, back, found_back, cv::noArray(), window,
                           kTopLevel, stop);
  const double limit = kRoundTripPx / ToReference(from.cols);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (found_there[i] != 0 && found_back[i] != 0 && cv::norm(back[i] - corners[i]) < limit) {
      matches.push_back({{corners[i].x, corners[i].y}, {there[i].x, there[i].y}});
    }
  }
  return matches;
}

}  // namespace rsstab::stabilizer::detail
