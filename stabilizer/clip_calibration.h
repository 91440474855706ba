// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_CLIP_CALIBRATION_H_
#define RSSTAB_STABILIZER_CLIP_CALIBRATION_H_

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "stabilizer/rs_motion_window.h"
#include "stabilizer/track_cells.h"

namespace rsstab::stabilizer {

// A number with one standard deviation. `sigma` is 0 where the value was given.
struct Estimate {
  double value = 0.0;
  double sigma = 0.0;
  // The clip determines it, or it was given. Otherwise the value is what was assumed.
  bool trusted = false;
};

// How well one readout time explains the most telling stretch of the clip.
struct ReadoutHypothesis {
  double readout_s = 0.0;
  double log_evidence = 0.0;  // natural logarithm, of the best hypothesis = 0
};

enum class ShutterVerdict {
  kRolling,       // the clip shows a rolling shutter
  kGlobal,        // the clip shows that there is none worth correcting
  kCannotBeTold,  // too little motion or texture: nothing should be corrected
  kGiven,         // the readout time was given
};

// "rolling", "global", "unknown" or "given", for files and programs.
[[nodiscard]] constexpr std::string_view NameOf(ShutterVerdict verdict) {
  switch (verdict) {
    case ShutterVerdict::kRolling:
      return "rolling";
    case ShutterVerdict::kGlobal:
      return "global";
    case ShutterVerdict::kGiven:
      return "given";
    case ShutterVerdict::kCannotBeTold:
      break;
  }
  return "unknown";
}

// Tracks that a rotation explains up to this, median over the picture and at 640 px width, come
// from a camera that only turns (simulated: up to 0.04); walking past things moves them by more
// (four hand-held clips: from 0.13), and feigns a longer lens.
inline constexpr double kMaxTurningParallax_px = 0.08;

// What is the same for the whole clip, as its tracks tell it.
struct ClipCalibration {
  ShutterVerdict verdict = ShutterVerdict::kCannotBeTold;
  Estimate readout_s;  // signed, first row to last; 0 unless kRolling or kGiven
  std::optional<Estimate> tracks_readout_s;    // what the tracks alone say
  std::optional<Estimate> pictures_readout_s;  // what single pictures alone say
  Estimate focal;                              // picture widths
  double jerk_weight = 0.1;
  // The camera vibrates so fast that one frame's motion says little of the next one's. The readout
  // then corrects this clip, but as the camera's it is neither precise nor trusted (`readout_s`).
  bool vibrates = false;
  std::vector<ReadoutHypothesis> curve;  // in order of readout; empty when given
  std::size_t num_windows = 0;           // stretches of the clip that it is based on
  // Motion between frames that no rotation explains, median over the picture: px at 640 px width.
  // Near 0 for a camera that only turns, or a scene that is far away.
  double parallax_px = 0.0;
};

struct ClipCalibrationOptions {
  double frame_interval_s = 1.0 / 30.0;  // nominal
  std::optional<double> readout_s;       // given: not estimated
  std::optional<double> focal;           // given, picture widths
  int num_threads = 1;                   // at least 1
};

// Finds readout time and focal length of a clip from its tracks, by the marginal likelihood of
// readout times over the stretches in which the camera's velocity changes most (a steady pan skews
// every frame alike and says nothing here). Keeps those stretches only: memory does not grow with
// the clip. In order, not thread safe.
class ClipCalibrator {
 public:
  explicit ClipCalibrator(const ClipCalibrationOptions& options) : options_(options) {}

  // The next pair of consecutive frames. One without cells ends a stretch.
  void Push(FramePairCells pair);

  // Answers for what was pushed so far. `pictures`: what single pictures say of the readout time,
  // s; joined with what the tracks say by their variances, unless the two contradict each other.
  [[nodiscard]] ClipCalibration Calibrate(const std::optional<Estimate>& pictures = {});

  // (readout in frame intervals, log of the focal length), and one standard deviation of each.
  struct Consensus {
    Eigen::Vector2d value = Eigen::Vector2d::Zero();
    Eigen::Vector2d sigma = Eigen::Vector2d::Zero();
    double parallax_px = 0.0;
  };

 private:
  // Log evidence by readout time and stiffness.
  struct EvidenceTable {
    std::vector<std::vector<double>> by_weight;
    [[nodiscard]] double At(std::size_t readout) const;  // with its best stiffness
    [[nodiscard]] double JerkWeight(std::size_t readout) const;
  };
  struct Stretch {
    std::vector<FramePairCells> pairs;
    double excitement = 0.0;
  };
  void FinishStretch();
  // Over the stretches from `first` to `last` - 1.
  [[nodiscard]] EvidenceTable MakeEvidenceTable(const std::vector<double>& readouts_s,
                                                std::size_t first, std::size_t last) const;
  // The readout time, of those on a grid, that explains the stretches best.
  void SearchReadout(ClipCalibration& result, double& readout_s, bool& beats_global) const;
  [[nodiscard]] Consensus Refine(double readout_s, double jerk_weight) const;

  ClipCalibrationOptions options_;
  std::vector<FramePairCells> current_;
  std::optional<double> repeated_since_s_;  // time of the picture that the last frame repeats
  std::vector<Stretch> kept_;               // the most telling, best first
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_CLIP_CALIBRATION_H_
