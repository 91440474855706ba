// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_TRACK_CELLS_H_
#define RSSTAB_STABILIZER_TRACK_CELLS_H_

#include <Eigen/Core>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/point_tracks.h"

namespace rsstab::stabilizer {

// The tracks of one part of the picture, averaged: what moves there with the camera.
struct TrackCell {
  // Image plane of a pinhole, in picture widths from the principal point, x right, y down; rolling
  // shutter still in it, the lens taken out.
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  // Recorded rows as shares of the readout: exposed at frame time + readout * share, in [-.5, .5].
  double from_row_share = 0.0;
  double to_row_share = 0.0;
  double weight = 0.0;  // how many good tracks it stands for
};

// What two consecutive frames say about the camera's motion, small enough to keep.
struct FramePairCells {
  double from_time_s = 0.0;  // middle rows
  double to_time_s = 0.0;
  // Robust affine motion: to - from = affine * (1, x, y) in picture widths.
  Eigen::Matrix<double, 2, 3> affine = Eigen::Matrix<double, 2, 3>::Zero();
  double scatter = 0.0;  // typical distance of a track from a smooth motion, picture widths
  int num_inliers = 0;
  std::vector<TrackCell> cells;  // empty: the pair says nothing (a cut, a blank picture)
};

// Averages the tracks of a pair over a grid of cells (many rows, fewer columns: rolling shutter
// varies down the rows), leaving out those that do not move with the rest. `lens`, of any size,
// takes distortion out; null: a pinhole with its principal point in the middle. Any thread.
[[nodiscard]] FramePairCells SummarizeTracks(const PointTracks& tracks, const Camera* lens);

// True when the later frame shows the picture of the earlier one again.
[[nodiscard]] bool IsRepeat(const FramePairCells& pair);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_TRACK_CELLS_H_
