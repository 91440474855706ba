// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/rs_motion_fusion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rsstab::stabilizer {
namespace {

// How many of the last pairs of a window the next one decides again: what follows a frame tells
// about it as much as what precedes it.
constexpr std::size_t kWindowPairs = kFusionDelayFrames;
constexpr std::size_t kTailPairs = 20;
constexpr int kIterations = 4;
// A camera on a stand is not a chain of repeats.
constexpr int kMaxRepeats = 3;
// Pictures that follow each other more quickly carry wrong timestamps, frame intervals: recorders
// crowd the first ones together. What moved between them took a whole interval.
constexpr double kMinInterval = 0.4;
// Longer pauses tell nothing about the motion on either side.
constexpr double kMaxInterval = 5.0;

}  // namespace

void RsMotionFusion::Push(double time_s, FramePairCells pair) {
  const bool time_runs = time_s > last_time_s_;
  last_time_s_ = time_s;
  const double interval_s = time_s + clock_offset_s_ - content_time_s_;
  if (pair.cells.empty() || !time_runs || interval_s > kMaxInterval * model_.frame_interval_s) {
    EndPart();
    clock_offset_s_ = 0.0;
    content_time_s_ = time_s;
    num_repeats_ = 0;
  } else if (IsRepeat(pair) && num_repeats_ < kMaxRepeats) {
    ++num_repeats_;
  } else {
    if (interval_s < kMinInterval * model_.frame_interval_s) {
      clock_offset_s_ += model_.frame_interval_s - interval_s;
    }
    pair.from_time_s = content_time_s_;
    pair.to_time_s = time_s + clock_offset_s_;
    content_time_s_ = pair.to_time_s;
    pending_.push_back(std::move(pair));
    num_repeats_ = 0;
  }
  waiting_.push_back({content_time_s_, part_});
  if (pending_.size() >= kWindowPairs) {
    SolveWindow(kTailPairs);
  }
}

void RsMotionFusion::Finish() { EndPart(); }

std::vector<FusedFrame> RsMotionFusion::TakeReady() { return std::exchange(ready_, {}); }

void RsMotionFusion::SolveWindow(std::size_t tail) {
  ExtendStretch(model_, pending_, stretch_);
  RsMotionWindow window(model_, pending_, stretch_, num_fixed_, {});
  if (window.Solve(kIterations)) {
    stretch_ = window.Stretch();
  }
  const std::size_t num_decided = pending_.size() - tail;
  const double reach_s = 0.5 * std::abs(model_.readout_s);
  const double decided_until_s = pending_[num_decided - 1].to_time_s;
  EmitFrames(tail == 0 ? pending_.back().to_time_s : decided_until_s, stretch_);

  // Knots that rule the decided frames stay; pairs that only they rule are done with.
  const auto is_decided = [&](double time_s) {
    return time_s - 2.0 * stretch_.interval_s <= decided_until_s + reach_s;
  };
  std::size_t num_fixed = 0;
  while (num_fixed < stretch_.knots.size() && is_decided(stretch_.KnotTime(num_fixed))) {
    ++num_fixed;
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(num_decided));
  if (pending_.empty()) {
    return;
  }
  const double needed_from_s = pending_.front().from_time_s - SplineMargin(model_);
  std::size_t num_dropped = 0;
  while (num_dropped < num_fixed && stretch_.KnotTime(num_dropped + 1) <= needed_from_s) {
    ++num_dropped;
  }
  stretch_.start_s = stretch_.KnotTime(num_dropped);
  stretch_.knots.erase(stretch_.knots.begin(),
                       stretch_.knots.begin() + static_cast<std::ptrdiff_t>(num_dropped));
  num_fixed_ = std::max<std::size_t>(num_fixed - num_dropped, 1);
}

void RsMotionFusion::EndPart() {
  if (!pending_.empty()) {
    SolveWindow(0);
  }
  for (const WaitingFrame& frame : waiting_) {
    ready_.push_back({frame.time_s, frame.part, std::nullopt});
  }
  waiting_.clear();
  pending_.clear();
  stretch_ = {};
  num_fixed_ = 1;
  ++part_;
}

void RsMotionFusion::EmitFrames(double decided_until_s, const SplineStretch& stretch) {
  const double reach_s = 0.5 * std::abs(model_.readout_s) + 2.0 * stretch.interval_s;
  while (!waiting_.empty() && waiting_.front().time_s <= decided_until_s) {
    const WaitingFrame frame = waiting_.front();
    waiting_.pop_front();
    const auto first = static_cast<std::size_t>(
        std::max(0.0, std::floor((frame.time_s - reach_s - stretch.start_s) / stretch.interval_s)));
    igf::So3Spline spline(stretch.KnotTime(first), stretch.interval_s);
    for (std::size_t k = first; k < stretch.knots.size() &&
                                stretch.KnotTime(k) <= frame.time_s + reach_s + stretch.interval_s;
         ++k) {
      spline.Append(stretch.knots[k]);
    }
    ready_.push_back({frame.time_s, frame.part, std::move(spline)});
  }
}

}  // namespace rsstab::stabilizer
