// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_RS_MOTION_WINDOW_H_
#define RSSTAB_STABILIZER_RS_MOTION_WINDOW_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "stabilizer/track_cells.h"

namespace rsstab::stabilizer {

// What is the same for a whole clip.
struct RsMotionModel {
  double frame_interval_s = 1.0 / 30.0;  // nominal; spaces the knots
  double readout_s = 0.0;                // signed, |readout| <= frame interval
  double focal = 0.8;                    // picture widths
  // Stiffness of the motion: 1 / (typical jerk in px at 640 px width per frame^2.5). About 0.3 for
  // a hand, 0.01 for an airframe that vibrates.
  double jerk_weight = 0.1;
  // Error of one track beyond what the model knows (its own noise, depth of the scene), px at 640
  // px width.
  double track_sigma_px = 0.3;
};

inline constexpr int kKnotsPerFrame = 6;  // 60 Hz at 30 frames/s has three knots a period

// A stretch of a spline: knot k stands for start_s + k interval_s, world_from_camera.
struct SplineStretch {
  double start_s = 0.0;
  double interval_s = 0.0;
  std::vector<Eigen::Quaterniond> knots;

  [[nodiscard]] double KnotTime(std::size_t k) const {
    return start_s + static_cast<double>(k) * interval_s;
  }
  [[nodiscard]] double end_s() const { return KnotTime(knots.size()) - 2.0 * interval_s; }
};

// Time that the spline must reach beyond the middle rows of the first and last frame, s.
[[nodiscard]] double SplineMargin(const RsMotionModel& model);

// Lengthens a stretch by what the affine motions of the pairs say about the camera's turn (each
// frame pair at a constant rate) until it covers the last pair; an empty stretch begins at the
// first. `model` gives the knot spacing and the focal length.
void ExtendStretch(const RsMotionModel& model, std::span<const FramePairCells> pairs,
                   SplineStretch& stretch);

// One window of the fusion: the rotation spline that explains the row-timed tracks of some
// consecutive frame pairs, by robust least squares (Ceres). Not thread safe.
class RsMotionWindow {
 public:
  // Readout and focal length stay as the model gives them unless freed.
  struct Freedom {
    bool readout = false;
    bool focal = false;
  };
  // `stretch` covers all pairs (ExtendStretch) and is where the search starts; its first
  // `num_fixed` knots (at least one) stay as they are: what earlier windows decided.
  RsMotionWindow(const RsMotionModel& model, std::span<const FramePairCells> pairs,
                 SplineStretch stretch, std::size_t num_fixed, Freedom freedom);
  ~RsMotionWindow();
  RsMotionWindow(const RsMotionWindow&) = delete;
  RsMotionWindow& operator=(const RsMotionWindow&) = delete;

  // False when the solver found no usable answer; the state is then as before.
  [[nodiscard]] bool Solve(int max_iterations);

  [[nodiscard]] SplineStretch Stretch() const;
  [[nodiscard]] double readout_s() const;
  [[nodiscard]] double focal() const;  // picture widths

  // Information (inverse covariance) on (readout in s, log focal length), everything else
  // marginalised, at the present state.
  [[nodiscard]] Eigen::Matrix2d ClipInformation();

  // Logarithm of the marginal likelihood (up to a constant) for each of `jerk_weights`, with the
  // present readout and focal length: MacKay's evidence, linearised at the present state. What
  // says how stiff the motion is.
  [[nodiscard]] std::vector<double> LogEvidence(std::span<const double> jerk_weights);

  // Median distance, over the cells, between where a track ends and where the rotation alone says:
  // px at 640 px width. Objects that move by themselves hardly count.
  [[nodiscard]] double Parallax();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_RS_MOTION_WINDOW_H_
