// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/crop_planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rsstab::stabilizer {
namespace {

constexpr int kOutlinePointsPerSide = 24;
constexpr int kBisections = 13;  // 0.9 / 2^13: a tenth of a pixel at 1080p
// Room for what happens between the points of the outline and for float rounding of the map.
constexpr double kMarginPx = 0.25;

// A frame that is left alone needs no room.
constexpr double kRoundOffPx = 1e-6;

bool OutlineIsCovered(const FrameWarp& warp, double crop_ratio, double margin_px) {
  const double cx = (warp.width - 1) / 2.0;
  const double cy = (warp.height - 1) / 2.0;
  const double half_x = cx * crop_ratio;
  const double half_y = cy * crop_ratio;
  const double margin_x = std::min(margin_px, cx);
  const double margin_y = std::min(margin_px, cy);
  const auto covered = [&](double x, double y) {
    const auto source = SourcePosition(warp, {cx + x, cy + y});
    return source && source->x() >= margin_x && source->x() <= warp.width - 1 - margin_x &&
           source->y() >= margin_y && source->y() <= warp.height - 1 - margin_y;
  };
  for (int i = 0; i <= kOutlinePointsPerSide; ++i) {
    const double s = 2.0 * i / kOutlinePointsPerSide - 1.0;
    if (!covered(s * half_x, -half_y) || !covered(s * half_x, half_y) ||
        !covered(-half_x, s * half_y) || !covered(half_x, s * half_y)) {
      return false;
    }
  }
  return true;
}

}  // namespace

FrameWarp WithCrop(FrameWarp warp, double crop_ratio) {
  const double cx = (warp.width - 1) / 2.0;
  const double cy = (warp.height - 1) / 2.0;
  Eigen::Matrix3d window_from_output;
  window_from_output << crop_ratio, 0.0, cx * (1.0 - crop_ratio),  //
      0.0, crop_ratio, cy * (1.0 - crop_ratio),                    //
      0.0, 0.0, 1.0;
  warp.rectified_from_output = warp.rectified_from_output * window_from_output;
  return warp;
}

double LargestCropRatio(const FrameWarp& warp) {
  if (OutlineIsCovered(warp, 1.0, -kRoundOffPx)) {
    return 1.0;
  }
  double low = kMinCropRatio;
  double high = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (OutlineIsCovered(warp, middle, kMarginPx) ? low : high) = middle;
  }
  return low;
}

ZoomPlanner::ZoomPlanner(std::size_t reach) : weights_(reach + 1, 1.0), reach_(reach) {
  // Three standard deviations to either side.
  const double sigma = std::max(1.0, static_cast<double>(reach) / 3.0);
  for (std::size_t d = 0; d <= reach; ++d) {
    const double x = static_cast<double>(d) / sigma;
    weights_[d] = std::exp(-0.5 * x * x);
  }
}

void ZoomPlanner::Push(double allowed_ratio, bool path_begins) {
  if (path_begins && pushed_ > 0) {
    Finish();
  }
  allowed_.push_back(allowed_ratio);
  ++pushed_;
  // The mean at t needs minima up to t + reach, and those need limits up to t + 2 reach.
  if (pushed_ > 2 * reach_) {
    DecideUpTo(pushed_ - 2 * reach_);
  }
}

void ZoomPlanner::Finish() {
  DecideUpTo(pushed_);
  allowed_.clear();
  first_ = 0;
  decided_ = 0;
  pushed_ = 0;
}

void ZoomPlanner::DecideUpTo(std::size_t end) {
  const auto window_minimum = [&](std::size_t t) {
    const std::size_t from = std::max(first_, t > reach_ ? t - reach_ : 0);
    const std::size_t to = std::min(pushed_ - 1, t + reach_);
    return *std::min_element(allowed_.begin() + static_cast<std::ptrdiff_t>(from - first_),
                             allowed_.begin() + static_cast<std::ptrdiff_t>(to - first_ + 1));
  };
  for (; decided_ < end; ++decided_) {
    const std::size_t from = decided_ > reach_ ? decided_ - reach_ : 0;
    const std::size_t to = std::min(pushed_ - 1, decided_ + reach_);
    double sum = 0.0;
    double total = 0.0;
    for (std::size_t t = from; t <= to; ++t) {
      const double weight = weights_[t > decided_ ? t - decided_ : decided_ - t];
      sum += weight * window_minimum(t);
      total += weight;
    }
    ready_.push_back(sum / total);
    // Limits older than 2 reach are not looked at again.
    while (decided_ - first_ >= 2 * reach_ + 1) {
      allowed_.pop_front();
      ++first_;
    }
  }
}

std::vector<double> ZoomPlanner::TakeReady() { return std::exchange(ready_, {}); }

}  // namespace rsstab::stabilizer
