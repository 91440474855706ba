// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SYNC_PAIRS_H_
#define RSSTAB_IGF_SYNC_PAIRS_H_

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/point_tracks.h"
#include "igf/base/result.h"

namespace rsstab::igf {

// One match as the synchronisation sees it: lens undone, exposure times still open.
struct SyncMatch {
  // Image plane at distance 1 from the camera (x, y of a ray with z = 1), for the assumed focal
  // length.
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  // Exposure time = middle row's time + readout * row share, in (-0.5, 0.5).
  double from_row_share = 0.0;
  double to_row_share = 0.0;
  double column_share = 0.0;  // where `from` lies across the image, in (-0.5, 0.5)
  double px_per_unit = 1.0;   // local scale of the image plane at `to`, px of the tracks' size
};

// The usable matches between two consecutive frames.
struct SyncPair {
  double from_time_s = 0.0;  // middle rows, video clock
  double to_time_s = 0.0;
  std::vector<SyncMatch> matches;
  Eigen::Vector2d median_motion_px = Eigen::Vector2d::Zero();  // median displacement per axis
};

// Undoes the lens of `camera` (any size: it is rescaled to that of the tracks). Leaves out matches
// without a ray or far off the axis, frame pairs with fewer than `min_matches` left, and pairs
// whose later frame is not later (damaged timestamps); thins a pair evenly to `max_matches`.
// Errors: kInvalidArgument for an invalid camera or tracks of different sizes.
[[nodiscard]] Result<std::vector<SyncPair>> PrepareSyncPairs(std::span<const PointTracks> tracks,
                                                             const Camera& camera,
                                                             std::size_t min_matches,
                                                             std::size_t max_matches);

// At most `count` of the pairs, in time order: half of them where the motion differs most from that
// of the neighbours (only changes tell time), the rest spread evenly over the clip.
[[nodiscard]] std::vector<SyncPair> SelectInformativePairs(std::span<const SyncPair> pairs,
                                                           std::size_t count);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SYNC_PAIRS_H_
