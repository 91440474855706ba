// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PATH_WINDOW_DETAIL_H_
#define RSSTAB_STABILIZER_PATH_WINDOW_DETAIL_H_

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <vector>

#include "stabilizer/camera_path.h"
#include "stabilizer/update_parameters_detail.h"

namespace rsstab::stabilizer {

// One frame of the window over which the bundled paths are solved.
struct PathFrame {
  FrameMotion motion;
  double pan_weight = 1.0;
  double relaxation = 1.0;  // share of the temporal weights that crop limit and shape leave
  UpdateParameters theta{};
  std::vector<Eigen::Vector2d> local_path;    // C of every spatial mode, chained motion
  std::vector<Eigen::Vector2d> local_smooth;  // P of every spatial mode
};

// The frames of one camera path that a decision rests on: some that are decided, which the next
// ones lean on; the open ones; and, while a window is solved, some that nobody has seen yet. Not
// thread safe.
class PathWindow {
 public:
  explicit PathWindow(double frames_per_second) : frames_per_second_(frames_per_second) {}

  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  [[nodiscard]] PathFrame& operator[](std::size_t i) { return frames_[i]; }
  [[nodiscard]] const PathFrame& operator[](std::size_t i) const { return frames_[i]; }
  [[nodiscard]] std::size_t first_open() const { return num_decided_; }
  [[nodiscard]] std::size_t first_guessed() const { return frames_.size() - num_guessed_; }
  // Seen and not decided.
  [[nodiscard]] std::size_t num_open() const { return first_guessed() - num_decided_; }

  // Forgets everything: the next frame begins another path.
  void Clear();
  // The next frame. `local_step`: its local motion, a coefficient per spatial mode.
  void Append(const FrameMotion& motion, std::vector<Eigen::Vector2d> local_step);
  // The next `count` open frames are decided. Of the decided ones only a few stay.
  void MarkDecided(std::size_t count);

  // Goes on with `count` frames in which the camera does what it did of late, dying away: the path
  // then knows where it is heading and does not overshoot.
  void Guess(std::size_t count);
  // Takes them off again. What they were solved to is where the frames to come begin.
  void DropGuesses();

  // Relaxes the frames around a fast pan: it is meant.
  void UpdatePanWeights();
  // Square root of a temporal weight for the frames from `last` - `span` to `last`: `weight` as far
  // as their pan weights and relaxations leave it.
  [[nodiscard]] double TemporalWeight(double weight, std::size_t last, std::size_t span) const;

 private:
  void FollowIntent(const FrameMotion& motion);

  double frames_per_second_;
  std::deque<PathFrame> frames_;
  std::size_t num_decided_ = 0;                // at the front
  std::size_t num_guessed_ = 0;                // at the end
  std::deque<UpdateParameters> kept_guesses_;  // of the frames to come, by the last window
  Eigen::Vector2d intent_ = Eigen::Vector2d::Zero();
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_PATH_WINDOW_DETAIL_H_
