// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/online_zoom_planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rsstab::stabilizer {

OnlineZoomPlanner::OnlineZoomPlanner(std::size_t lookahead, std::size_t hold, double max_widening)
    : lookahead_(lookahead), hold_(hold), max_widening_(max_widening), weights_(lookahead + 1) {
  // Three standard deviations to either side of the mean's middle.
  const double middle = static_cast<double>(lookahead) / 2.0;
  const double sigma = std::max(1.0, middle / 3.0);
  for (std::size_t back = 0; back < weights_.size(); ++back) {
    const double x = (static_cast<double>(back) - middle) / sigma;
    weights_[back] = std::exp(-0.5 * x * x);
  }
}

void OnlineZoomPlanner::Push(double allowed_ratio, bool path_begins) {
  if (path_begins) {
    Finish();
  }
  allowed_.push_back(allowed_ratio);
  ++undecided_;
  if (undecided_ > lookahead_) {
    DecideNext();
  }
}

void OnlineZoomPlanner::Finish() {
  while (undecided_ > 0) {
    DecideNext();
  }
  allowed_.clear();
  minima_.clear();
}

void OnlineZoomPlanner::DecideNext() {
  // allowed_ holds at most hold_ decided frames, then the open ones.
  const std::size_t now = allowed_.size() - undecided_;
  const std::size_t end = std::min(allowed_.size(), now + lookahead_ + 1);
  const double minimum =
      *std::min_element(allowed_.begin(), allowed_.begin() + static_cast<std::ptrdiff_t>(end));
  const bool begins = minima_.empty();
  minima_.push_front(minimum);
  if (minima_.size() > weights_.size()) {
    minima_.pop_back();
  }
  double sum = 0.0;
  double total = 0.0;
  for (std::size_t back = 0; back < minima_.size(); ++back) {
    sum += weights_[back] * minima_[back];
    total += weights_[back];
  }
  last_ = begins ? sum / total : std::min(sum / total, last_ + max_widening_);
  ready_.push_back(last_);
  --undecided_;
  if (now + 1 > hold_) {
    allowed_.pop_front();
  }
}

std::vector<double> OnlineZoomPlanner::TakeReady() { return std::exchange(ready_, {}); }

}  // namespace rsstab::stabilizer
