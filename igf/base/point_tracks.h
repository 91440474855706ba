// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_POINT_TRACKS_H_
#define RSSTAB_IGF_BASE_POINT_TRACKS_H_

#include <Eigen/Core>
#include <vector>

#include "igf/base/rolling_shutter.h"

namespace rsstab {

// One scene point seen in two consecutive frames, each in the pixels of that frame as recorded
// (rolling shutter and lens distortion still in it).
struct PointMatch {
  Eigen::Vector2f from = Eigen::Vector2f::Zero();  // in the earlier frame
  Eigen::Vector2f to = Eigen::Vector2f::Zero();    // in the later frame
};

// The matches between two consecutive frames. Because a point's row tells when it was exposed,
// every match carries its two exposure times once the readout time is known.
struct PointTracks {
  int width = 0;  // image size in which the pixels are stated
  int height = 0;
  double from_time_s = 0.0;  // time of the earlier frame's middle row
  double to_time_s = 0.0;    // time of the later frame's middle row
  std::vector<PointMatch> matches;

  [[nodiscard]] double FromExposureTime(const PointMatch& match, double readout_s) const {
    return RowExposureTime(from_time_s, static_cast<double>(match.from.y()), height, readout_s);
  }
  [[nodiscard]] double ToExposureTime(const PointMatch& match, double readout_s) const {
    return RowExposureTime(to_time_s, static_cast<double>(match.to.y()), height, readout_s);
  }
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_POINT_TRACKS_H_
