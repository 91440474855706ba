// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/metrics/wobble.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "igf/base/homography.h"
#include "stabilizer/metrics/luma_detail.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kLargestPx = 8.0;
constexpr int kBands = 18;
constexpr int kFewestInHalf = 3;

struct Half {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
};

}  // namespace

void WobbleMeter::Add(std::span<const PointMatch> matches, const Eigen::Matrix3d& to_from_from) {
  const double to_reference = detail::ToReference(width_);
  std::array<std::array<Half, 2>, kBands> bands;
  for (const PointMatch& match : matches) {
    const auto expected = ProjectChecked(to_from_from, match.from.cast<double>());
    if (!expected) {
      continue;
    }
    const Eigen::Vector2d residual = (match.to.cast<double>() - *expected) * to_reference;
    if (residual.norm() < kLargestPx) {
      squares_ += residual.squaredNorm();
      ++matches_;
    }
    const int band = static_cast<int>(static_cast<double>(match.from.y()) * kBands / height_);
    auto& halves = bands[static_cast<std::size_t>(std::clamp(band, 0, kBands - 1))];
    Half& half = halves[0].count <= halves[1].count ? halves[0] : halves[1];
    half.sum += residual;
    ++half.count;
  }
  double products = 0.0;
  int counted = 0;
  for (const auto& [first, second] : bands) {
    if (std::min(first.count, second.count) >= kFewestInHalf) {
      products += (first.sum / first.count).dot(second.sum / second.count);
      ++counted;
    }
  }
  if (counted > 0) {
    row_sum_ += std::sqrt(std::max(0.0, products / counted));
    ++row_frames_;
  }
}

std::optional<double> WobbleMeter::Wobble() const {
  if (matches_ == 0) {
    return std::nullopt;
  }
  return std::sqrt(squares_ / static_cast<double>(matches_));
}

std::optional<double> WobbleMeter::RowWobble() const {
  if (row_frames_ == 0) {
    return std::nullopt;
  }
  return row_sum_ / static_cast<double>(row_frames_);
}

}  // namespace rsstab::stabilizer
