// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/quality_metrics.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "stabilizer/metrics/image_metrics.h"
#include "stabilizer/metrics/luma_detail.h"
#include "stabilizer/metrics/metric_tracks_detail.h"
#include "stabilizer/metrics/path_metrics.h"
#include "stabilizer/metrics/robust_homography.h"
#include "stabilizer/metrics/wobble.h"

namespace rsstab::stabilizer {
namespace {

// Cauchy scale of the motion between consecutive frames, px; see docs/metrics.md.
constexpr double kMotionScalePx = 2.5;

double ConsecutivePsnr(const cv::Mat& a, const cv::Mat& b, int bit_depth) {
  const double mean = cv::norm(a, b, cv::NORM_L2SQR) / static_cast<double>(a.total());
  const double peak = static_cast<double>((1 << bit_depth) - 1);
  return mean > 0.0 ? std::min(kLargestPsnrDb, 10.0 * std::log10(peak * peak / mean))
                    : kLargestPsnrDb;
}

}  // namespace

struct ClipMeter::Impl {
  cv::Mat native;  // luma of the previous frame, at full size
  cv::Mat small;   // and at the size of tracking
  int bit_depth = 8;
  std::int64_t frames = 0;
  std::int64_t unmeasured = 0;
  std::size_t tracks = 0;
  double psnr_sum = 0.0;
  std::vector<std::optional<Eigen::Matrix3d>> motions;
  std::optional<WobbleMeter> wobble;
};

ClipMeter::ClipMeter() : impl_(std::make_unique<Impl>()) {}
ClipMeter::~ClipMeter() = default;
ClipMeter::ClipMeter(ClipMeter&&) noexcept = default;
ClipMeter& ClipMeter::operator=(ClipMeter&&) noexcept = default;

Status ClipMeter::Push(const FrameView& frame) {
  Impl& state = *impl_;
  const auto luma = detail::NativeLuma(frame);
  if (!luma) {
    return Propagate(luma.error());
  }
  if (state.frames > 0 &&
      (luma->size() != state.native.size() || frame.layout.bit_depth != state.bit_depth)) {
    return Fail(ErrorCode::kInvalidArgument,
                "Frame {} is {}x{}, the frames before it are {}x{}; a clip must keep its size.",
                state.frames, frame.width, frame.height, state.native.cols, state.native.rows);
  }
  state.bit_depth = frame.layout.bit_depth;
  cv::Mat small = detail::MetricPicture(*luma, state.bit_depth);
  if (state.frames == 0) {
    state.wobble.emplace(small.cols, small.rows);
  } else {
    state.psnr_sum += ConsecutivePsnr(state.native, *luma, state.bit_depth);
    const std::vector<PointMatch> matches = detail::MetricTracks(state.small, small);
    const double scale = kMotionScalePx / detail::ToReference(small.cols);
    state.motions.push_back(RobustHomography(matches, scale));
    state.tracks += matches.size();
    if (state.motions.back()) {
      state.wobble->Add(matches, *state.motions.back());
    } else {
      ++state.unmeasured;
    }
  }
  luma->copyTo(state.native);
  state.small = std::move(small);
  ++state.frames;
  return {};
}

ClipMetrics ClipMeter::Measure(double frames_per_second) const {
  const Impl& state = *impl_;
  ClipMetrics result;
  result.frames = state.frames;
  result.unmeasured_motions = state.unmeasured;
  if (state.frames < 2) {
    return result;
  }
  const auto pairs = static_cast<double>(state.frames - 1);
  const int width = state.small.cols;
  const int height = state.small.rows;
  result.tracks_per_frame = static_cast<double>(state.tracks) / pairs;
  result.itf_db = state.psnr_sum / pairs;
  if (state.unmeasured == state.frames - 1) {
    return result;
  }
  result.wobble = state.wobble->Wobble();
  result.row_wobble = state.wobble->RowWobble();
  result.jitter = Jitter(state.motions, width, height);
  result.shake = Shake(state.motions, width, height, frames_per_second);
  if (const auto stability = PathStability(state.motions, width, height)) {
    result.stability_move = stability->translation;
    result.stability_turn = stability->rotation;
    result.stability = std::min(stability->translation, stability->rotation);
  }
  return result;
}

std::vector<PicturePose> ClipMeter::Path() const {
  return impl_->frames == 0 ? std::vector<PicturePose>{}
                            : PicturePath(impl_->motions, impl_->small.cols, impl_->small.rows);
}

std::optional<Eigen::Vector2d> ClipMeter::LastStep() const {
  if (impl_->motions.empty() || !impl_->motions.back()) {
    return std::nullopt;
  }
  const MotionList last(&impl_->motions.back(), 1);
  return PicturePath(last, impl_->small.cols, impl_->small.rows).back().position;
}

}  // namespace rsstab::stabilizer
