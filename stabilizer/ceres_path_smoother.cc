// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "stabilizer/local_path_problem_detail.h"
#include "stabilizer/normalized_coordinates.h"
#include "stabilizer/path_crop_limit_detail.h"
#include "stabilizer/path_smoother.h"
#include "stabilizer/path_smoothness_detail.h"
#include "stabilizer/path_window_detail.h"
#include "stabilizer/spatial_modes.h"

namespace rsstab::stabilizer {
namespace {

// Local paths: highest mode, and the largest local update.
constexpr int kMaxModeOrder = 5;
constexpr double kMaxLocalUpdate = 8.0 / kReferenceWidthPx;

// With a short look-ahead the window goes on with frames that nobody has seen yet, up to
// kGuessShare of smoothness_s, at most kMaxGuesses, beyond the frames to be decided. (A share of
// 0.6 instead of 2 at a look-ahead of 15 frames: 60% more jitter, and at most 70% of a side kept
// instead of 84%, over a hand-held shot.)
constexpr double kGuessShare = 2.0;
constexpr long kMaxGuesses = 90;
// Frames decided at once, as a share of the look-ahead: each solve costs the same.
constexpr std::size_t kCommitShare = 4;

// Guesses `count` frames at the end of a window, and takes them off again.
class GuessedFrames {
 public:
  GuessedFrames(PathWindow& window, std::size_t count) : window_(window) { window_.Guess(count); }
  ~GuessedFrames() { window_.DropGuesses(); }
  GuessedFrames(const GuessedFrames&) = delete;
  GuessedFrames& operator=(const GuessedFrames&) = delete;

 private:
  PathWindow& window_;
};

class CeresPathSmoother final : public PathSmoother {
 public:
  explicit CeresPathSmoother(const PathSmootherOptions& options)
      : options_(options),
        modes_(options.mesh_columns, options.mesh_rows, kMaxModeOrder),
        window_(options.frames_per_second) {
    if (options.lookahead_frames) {
      // commit_ + look_ahead_ open frames set off a decision: one more than the look-ahead.
      const auto delay = static_cast<std::size_t>(*options.lookahead_frames);
      commit_ = std::max<std::size_t>(1, delay / kCommitShare);
      look_ahead_ = delay + 1 - commit_;
    } else {
      look_ahead_ = static_cast<std::size_t>(
          std::clamp(std::lround(2.0 * SmoothnessFrames(options)), 30L, 240L));
      commit_ = std::max<std::size_t>(look_ahead_ / 2, 15);
    }
  }

  Status Push(const FrameMotion& motion) override {
    if (motion.path_begins) {
      if (Status ok = Finish(); !ok) {
        return ok;
      }
      window_.Clear();
      path_ended_ = false;
    }
    std::vector<Eigen::Vector2d> local_step(modes_.count(), Eigen::Vector2d::Zero());
    if (!motion.local.empty() && window_.size() > 0) {
      local_step = modes_.Analyze(motion.local);
    }
    window_.Append(motion, std::move(local_step));
    if (window_.num_open() >= commit_ + look_ahead_) {
      return Decide(commit_);
    }
    return {};
  }

  Status Finish() override {
    path_ended_ = true;
    while (window_.num_open() > 0) {
      const std::size_t open = window_.num_open();
      // The last window is solved in one piece, so that no short tail is decided without a future.
      if (Status ok = Decide(open <= commit_ + look_ahead_ ? open : commit_); !ok) {
        return ok;
      }
    }
    return {};
  }

  Status Update(const PathSmootherOptions& options) override {
    options_.smoothness_s = options.smoothness_s;
    options_.tripod = options.tripod;
    options_.min_crop_ratio = options.min_crop_ratio;
    return {};
  }

  std::vector<PathUpdate> TakeReady() override { return std::exchange(ready_, {}); }

 private:
  // Solves over all frames at hand and decides the next `count`.
  Status Decide(std::size_t count) {
    if (options_.smoothness_s > 0.0 || options_.tripod) {
      const GuessedFrames guessed(window_, NumGuesses(count));
      window_.UpdatePanWeights();
      if (Status ok = SolvePathWithinCrop(options_, window_); !ok) {
        return ok;
      }
      if (Status ok = SolveLocalPaths(options_, modes_, window_); !ok) {
        return ok;
      }
    }
    const std::size_t first = window_.first_open();
    for (std::size_t i = first; i < first + count; ++i) {
      ready_.push_back(MakeUpdate(window_[i]));
    }
    window_.MarkDecided(count);
    return {};
  }

  // Frames to be guessed for a decision on `count` frames.
  [[nodiscard]] std::size_t NumGuesses(std::size_t count) const {
    const auto horizon = static_cast<std::size_t>(
        std::min(std::lround(kGuessShare * SmoothnessFrames(options_)), kMaxGuesses));
    const std::size_t seen = window_.num_open() - count;
    return !options_.lookahead_frames || path_ended_ || seen >= horizon ? 0 : horizon - seen;
  }

  [[nodiscard]] PathUpdate MakeUpdate(const PathFrame& frame) const {
    PathUpdate update;
    update.rung = frame.motion.rung;
    update.path_begins = frame.motion.path_begins;
    update.rectified_from_output = UpdateHomography(frame.theta, options_.focal_ratio);
    std::vector<Eigen::Vector2d> coefficients(modes_.count());
    double largest = 0.0;
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
      coefficients[k] = frame.local_path[k] - frame.local_smooth[k];
      largest = std::max(largest, coefficients[k].norm());
    }
    if (largest > 0.0) {
      update.mesh_update = modes_.Synthesize(coefficients);
      for (Eigen::Vector2d& d : update.mesh_update) {
        // Soft limit: a local update this large is a wrong one, and must not tear the picture.
        d /= std::sqrt(1.0 + d.squaredNorm() / (kMaxLocalUpdate * kMaxLocalUpdate));
      }
    }
    return update;
  }

  PathSmootherOptions options_;
  SpatialModes modes_;
  PathWindow window_;
  std::size_t look_ahead_ = 60;
  std::size_t commit_ = 30;
  bool path_ended_ = false;  // no frame will be added to the window
  std::vector<PathUpdate> ready_;
};

}  // namespace

Result<std::unique_ptr<PathSmoother>> MakeCeresPathSmoother(const PathSmootherOptions& options) {
  if (!(options.aspect > 0.0) || !(options.frames_per_second > 0.0) ||
      !(options.focal_ratio > 0.0) || !(options.smoothness_s >= 0.0) ||
      !(options.min_crop_ratio > 0.0 && options.min_crop_ratio <= 1.0) ||
      options.mesh_columns < 1 || options.mesh_rows < 1 ||
      options.lookahead_frames.value_or(0) < 0) {
    return Fail(ErrorCode::kInvalidArgument,
                "path smoother: aspect {}, {} fps, focal ratio {}, smoothness {} s, crop ratio {}, "
                "mesh {}x{}, look-ahead {}: all must be positive, the crop ratio at most 1",
                options.aspect, options.frames_per_second, options.focal_ratio,
                options.smoothness_s, options.min_crop_ratio, options.mesh_columns,
                options.mesh_rows, options.lookahead_frames.value_or(0));
  }
  return std::make_unique<CeresPathSmoother>(options);
}

}  // namespace rsstab::stabilizer
