// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_ONLINE_ZOOM_PLANNER_H_
#define RSSTAB_STABILIZER_ONLINE_ZOOM_PLANNER_H_

#include <cstddef>
#include <deque>
#include <vector>

namespace rsstab::stabilizer {

// What ZoomPlanner (crop_planner.h) does, for a look-ahead shorter than it wants: narrows within
// the look-ahead, and widens slowly, since what comes is not known. Never exceeds what is allowed:
// each value that enters the mean at t is the smallest of a window that holds t.
class OnlineZoomPlanner {
 public:
  // `lookahead`: frames that each decision waits for; 0 narrows at once. `hold`: frames for which a
  // narrowing is kept. `max_widening`: largest growth of the ratio from one frame to the next, > 0.
  OnlineZoomPlanner(std::size_t lookahead, std::size_t hold, double max_widening);

  // The crop ratio that the next frame allows; `path_begins` starts afresh (a cut hides the jump).
  void Push(double allowed_ratio, bool path_begins);
  // No more frames will come.
  void Finish();
  // Planned ratios decided since the last call, one per frame, in order.
  [[nodiscard]] std::vector<double> TakeReady();

 private:
  void DecideNext();

  std::size_t lookahead_;
  std::size_t hold_;
  double max_widening_;
  std::vector<double> weights_;  // of the mean, index = frames back
  std::deque<double> allowed_;   // of the current path, the undecided ones last
  std::size_t undecided_ = 0;
  std::deque<double> minima_;  // of the windows of the frames decided last, newest first
  double last_ = 1.0;          // ratio decided last
  std::vector<double> ready_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_ONLINE_ZOOM_PLANNER_H_
