// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/feature_tracks.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

namespace rsstab::stabilizer {
namespace {

constexpr int kMaxIterations = 20;
constexpr double kConvergedPx = 0.01;
// Below this a window has no texture to lock on to (Lucas-Kanade's own test).
constexpr double kMinEigenvalue = 1e-4;
constexpr int kMinTrackableSide = 32;
// Corners are rated strip by strip: what OpenCV needs in between then stays in the cache, and is
// small enough for the allocator to keep. For whole pictures it gave the memory back to the system
// each time, and page faults took a fifth of the analysis.
constexpr int kStripRows = 32;
constexpr int kCornerBlock = 3;

}  // namespace

struct FeatureTracker::Impl {
  FeatureTrackerOptions options;
  cv::Size size;
  double previous_time_s = 0.0;
  std::vector<cv::Mat> previous_pyramid;
  std::vector<cv::Point2f> points;  // in the previous picture
  cv::Mat strength;                 // of the corner at each pixel

  [[nodiscard]] std::vector<cv::Mat> BuildPyramid(const cv::Mat& image) const {
    std::vector<cv::Mat> pyramid;
    cv::buildOpticalFlowPyramid(image, pyramid, cv::Size(options.window_px, options.window_px),
                                options.pyramid_levels - 1);
    return pyramid;
  }

  [[nodiscard]] std::vector<unsigned char> Follow(const std::vector<cv::Mat>& from,
                                                  const std::vector<cv::Mat>& to,
                                                  const std::vector<cv::Point2f>& start,
                                                  std::vector<cv::Point2f>& end) const {
    std::vector<unsigned char> found;
    std::vector<float> error;
    cv::calcOpticalFlowPyrLK(from, to, start, end, found, error,
                             cv::Size(options.window_px, options.window_px),
                             options.pyramid_levels - 1,
                             cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS,
                                              kMaxIterations, kConvergedPx),
                             0, kMinEigenvalue);
    return found;
  }

  // The smaller eigenvalue of the gradients around each pixel.
  void RateCorners(const cv::Mat& image) {
    constexpr int kHalo = kCornerBlock / 2;
    strength.create(image.size(), CV_32F);
    cv::Mat strip;
    for (int top = 0; top < image.rows; top += kStripRows) {
      const int bottom = std::min(top + kStripRows, image.rows);
      const int first = std::max(top - kHalo, 0);
      const int last = std::min(bottom + kHalo, image.rows);
      cv::cornerMinEigenVal(image.rowRange(first, last), strip, kCornerBlock);
      strip.rowRange(top - first, bottom - first).copyTo(strength.rowRange(top, bottom));
    }
  }

  // Adds the best corner of every cell that holds no point.
  void Replenish(const cv::Mat& image) {
    const int cell = options.cell_px;
    const int columns = (size.width + cell - 1) / cell;
    const int rows = (size.height + cell - 1) / cell;
    const auto index_of = [columns](int column, int row) {
      return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
             static_cast<std::size_t>(column);
    };
    std::vector<bool> taken(index_of(0, rows), false);
    const auto cell_of = [&](const cv::Point2f& p) {
      const int c = std::clamp(static_cast<int>(p.x) / cell, 0, columns - 1);
      const int r = std::clamp(static_cast<int>(p.y) / cell, 0, rows - 1);
      return index_of(c, r);
    };
    // Two points that drifted into one cell see the same thing: keep the elder.
    std::erase_if(points, [&](const cv::Point2f& p) {
      const std::size_t index = cell_of(p);
      const bool crowded = taken[index];
      taken[index] = true;
      return crowded;
    });
    RateCorners(image);
    double strongest = 0.0;
    cv::minMaxLoc(strength, nullptr, &strongest);
    const auto threshold = static_cast<float>(
        std::max(options.min_corner_strength, options.min_corner_quality * strongest));
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        if (taken[index_of(c, r)]) {
          continue;
        }
        const int x0 = std::max(c * cell, options.border_px);
        const int y0 = std::max(r * cell, options.border_px);
        const int x1 = std::min((c + 1) * cell, size.width - options.border_px);
        const int y1 = std::min((r + 1) * cell, size.height - options.border_px);
        float best = threshold;
        cv::Point2f position(-1.0F, -1.0F);
        for (int y = y0; y < y1; ++y) {
          const float* line = strength.ptr<float>(y);
          for (int x = x0; x < x1; ++x) {
            if (line[x] > best) {
              best = line[x];
              position = cv::Point2f(static_cast<float>(x), static_cast<float>(y));
            }
          }
        }
        if (position.x >= 0.0F) {
          points.push_back(position);
        }
      }
    }
  }
};

FeatureTracker::FeatureTracker(const FeatureTrackerOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
}

FeatureTracker::~FeatureTracker() = default;

Result<FeatureTracker::Output> FeatureTracker::Push(const GrayImage& image, double time_s) {
  Impl& s = *impl_;
  const cv::Size size(image.width, image.height);
  if (!s.previous_pyramid.empty() && size != s.size) {
    return Fail(ErrorCode::kInvalidArgument,
                "the picture size changes from {}x{} to {}x{} inside the clip", s.size.width,
                s.size.height, size.width, size.height);
  }
  const bool first = s.previous_pyramid.empty();
  s.size = size;
  Output output;
  output.tracks.width = image.width;
  output.tracks.height = image.height;
  output.tracks.from_time_s = first ? time_s : s.previous_time_s;
  output.tracks.to_time_s = time_s;
  s.previous_time_s = time_s;
  if (std::min(image.width, image.height) < kMinTrackableSide) {
    return output;  // too small to track: the coarser rungs hold still
  }
  try {
    // cv::Mat has no const view; the pyramid copies the picture, nothing writes to it.
    auto* data = const_cast<std::uint8_t*>(image.pixels.data());  // NOLINT
    const cv::Mat wrapped(size, CV_8U, data);
    std::vector<cv::Mat> pyramid = s.BuildPyramid(wrapped);
    if (!first && !s.points.empty()) {
      output.attempted = static_cast<int>(s.points.size());
      std::vector<cv::Point2f> there;
      std::vector<cv::Point2f> back;
      const auto found = s.Follow(s.previous_pyramid, pyramid, s.points, there);
      const auto returned = s.Follow(pyramid, s.previous_pyramid, there, back);
      std::vector<cv::Point2f> alive;
      const auto limit = static_cast<float>(s.options.max_forward_backward_px);
      const auto border = static_cast<float>(s.options.border_px);
      for (std::size_t i = 0; i < s.points.size(); ++i) {
        const cv::Point2f loop = back[i] - s.points[i];
        const cv::Point2f& p = there[i];
        const bool inside = p.x >= border && p.y >= border &&
                            p.x < static_cast<float>(size.width) - border &&
                            p.y < static_cast<float>(size.height) - border;
        if (found[i] == 0 || returned[i] == 0 || !inside || loop.dot(loop) > limit * limit) {
          continue;
        }
        output.tracks.matches.push_back(
            {Eigen::Vector2f(s.points[i].x, s.points[i].y), Eigen::Vector2f(p.x, p.y)});
        alive.push_back(p);
      }
      s.points = std::move(alive);
    }
    s.Replenish(wrapped);
    s.previous_pyramid = std::move(pyramid);
  } catch (const cv::Exception& e) {
    return Fail(ErrorCode::kInternal, "tracking at {:.3f} s failed: {}", time_s, e.what());
  }
  return output;
}

}  // namespace rsstab::stabilizer
