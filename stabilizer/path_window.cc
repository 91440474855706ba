// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "stabilizer/path_window_detail.h"

namespace rsstab::stabilizer {
namespace {

// A fast pan is meant: smoothing relaxes by exp(-(speed / kPanSpeed)^2), the Gaussian in path
// difference of Liu et al. 2013, eq. 2. Widths per second, of the motion averaged over kPanWindowS.
// Around two whip pans of 2 widths a second 94% of a side is kept; with 0.9 it was 76%.
constexpr double kPanSpeed = 0.3;
constexpr double kPanWindowS = 0.35;
constexpr double kMinPanWeight = 1e-3;
// The camera's intent is its mean motion of the last kIntentWindowS; guessed on, it dies away
// within kIntentDecayS.
constexpr double kIntentWindowS = 0.2;
constexpr double kIntentDecayS = 0.5;
constexpr std::size_t kHistory = 3;  // decided frames that the next window leans on

Eigen::Vector2d ShiftOf(const FrameMotion& motion) {
  const Eigen::Matrix3d& f = motion.to_from;
  return f.block<2, 1>(0, 2) / f(2, 2);
}

}  // namespace

void PathWindow::Clear() {
  frames_.clear();
  kept_guesses_.clear();
  num_decided_ = 0;
}

void PathWindow::Append(const FrameMotion& motion, std::vector<Eigen::Vector2d> local_step) {
  PathFrame frame;
  frame.motion = motion;
  frame.motion.path_begins = frames_.empty();
  frame.local_path = std::move(local_step);
  if (!frames_.empty()) {
    for (std::size_t k = 0; k < frame.local_path.size(); ++k) {
      frame.local_path[k] += frames_.back().local_path[k];
    }
  }
  frame.local_smooth = frame.local_path;
  FollowIntent(frame.motion);
  if (!kept_guesses_.empty()) {
    frame.theta = kept_guesses_.front();
    kept_guesses_.pop_front();
  }
  frames_.push_back(std::move(frame));
}

void PathWindow::MarkDecided(std::size_t count) {
  num_decided_ += count;
  while (num_decided_ > kHistory) {
    frames_.pop_front();
    --num_decided_;
  }
}

void PathWindow::Guess(std::size_t count) {
  for (std::size_t k = 1; k <= count; ++k) {
    PathFrame guess;
    const double decay = std::exp(-static_cast<double>(k) / (kIntentDecayS * frames_per_second_));
    guess.motion.to_from.topRightCorner<2, 1>() = decay * intent_;
    guess.theta = kept_guesses_.empty() ? frames_.back().theta : kept_guesses_.front();
    if (kept_guesses_.size() > 1) {
      kept_guesses_.pop_front();
    }
    guess.local_path = frames_.back().local_path;
    guess.local_smooth = frames_.back().local_smooth;
    frames_.push_back(std::move(guess));
  }
  num_guessed_ = count;
}

void PathWindow::DropGuesses() {
  kept_guesses_.clear();
  for (std::size_t i = first_guessed(); i < frames_.size(); ++i) {
    kept_guesses_.push_back(frames_[i].theta);
  }
  frames_.resize(first_guessed());
  num_guessed_ = 0;
}

// Mean motion from one frame to the next of late: what the camera means to do.
void PathWindow::FollowIntent(const FrameMotion& motion) {
  if (motion.path_begins) {
    intent_.setZero();
    return;
  }
  const double share = 1.0 / std::max(1.0, kIntentWindowS * frames_per_second_);
  intent_ += share * (ShiftOf(motion) - intent_);
}

// By the Gaussian mean of the camera's speed around every open frame.
void PathWindow::UpdatePanWeights() {
  const double sigma = kPanWindowS * frames_per_second_;
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(2.5 * sigma));
  std::vector<Eigen::Vector2d> speed(frames_.size(), Eigen::Vector2d::Zero());
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    speed[i] = ShiftOf(frames_[i].motion) * frames_per_second_;
  }
  for (std::size_t i = num_decided_; i < frames_.size(); ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double total = 0.0;
    for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
      const std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) + d;
      if (j < 0 || j >= static_cast<std::ptrdiff_t>(frames_.size())) {
        continue;
      }
      const double x = static_cast<double>(d) / sigma;
      const double w = std::exp(-0.5 * x * x);
      sum += w * speed[static_cast<std::size_t>(j)];
      total += w;
    }
    const double ratio = sum.norm() / total / kPanSpeed;
    frames_[i].pan_weight = std::max(kMinPanWeight, std::exp(-ratio * ratio));
  }
}

double PathWindow::TemporalWeight(double weight, std::size_t last, std::size_t span) const {
  double smallest = 1.0;
  for (std::size_t i = last - span; i <= last; ++i) {
    smallest = std::min(smallest, frames_[i].pan_weight * frames_[i].relaxation);
  }
  return weight * std::sqrt(smallest);
}

}  // namespace rsstab::stabilizer
