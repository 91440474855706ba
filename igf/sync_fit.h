// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SYNC_FIT_H_
#define RSSTAB_IGF_SYNC_FIT_H_

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "igf/orientation_track.h"
#include "igf/sync_pairs.h"

namespace rsstab::igf {

// What relates a gyro log to a clip.
struct SyncState {
  double offset_s = 0.0;  // t_video = t_gyro + offset
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();
  double log_focal = 0.0;  // logarithm of the true over the assumed focal length
  double curvature = 0.0;  // of the lens, see BendPlane; 0 = as assumed
  double readout_s = 0.0;
};

struct SyncFitOptions {
  bool fit_focal = false;
  bool fit_curvature = false;
  bool fit_readout = false;
  double frame_interval_s = 1.0 / 30.0;  // bounds the readout and scales its prior
  double offset_radius_s = 10e-3;        // how far the offset may move from its start
  std::size_t max_matches = 40;          // per pair, evenly thinned
  int max_iterations = 50;
};

struct SyncFit {
  SyncState state;
  // One standard deviation of each; infinite where the data say nothing, 0 where not estimated.
  SyncState sigma;
  bool offset_at_bound = false;  // not a minimum of its own
  // One entry for every given pair, px: the robust size (median length, capped) of its matches'
  // displacement, and of what the fit leaves of it. Equal where the log does not cover the pair.
  std::vector<double> motion_px;
  std::vector<double> residual_px;
  std::vector<bool> is_covered;
  // Root mean squares of these over the covered pairs.
  double rms_px = 0.0;
  double rms_without_gyro_px = 0.0;
};

// Robust nonlinear least squares (Ceres) on row-timed tracks, started at `start`. `track` on the
// gyro's clock, bias still in it. Empty when fewer than `kMinFitPairs` pairs are covered or the
// solver fails.
inline constexpr std::size_t kMinFitPairs = 15;
[[nodiscard]] std::optional<SyncFit> FitSync(std::span<const SyncPair> pairs,
                                             const OrientationTrack& track, const SyncState& start,
                                             const SyncFitOptions& options);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SYNC_FIT_H_
