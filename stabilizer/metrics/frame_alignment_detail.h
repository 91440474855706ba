// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_FRAME_ALIGNMENT_DETAIL_H_
#define RSSTAB_STABILIZER_METRICS_FRAME_ALIGNMENT_DETAIL_H_

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "igf/base/point_tracks.h"

namespace rsstab::stabilizer::detail {

// Two pictures of the same instant, brought together.
struct FrameAlignment {
  Eigen::Matrix3d second_from_first = Eigen::Matrix3d::Identity();  // robust homography
  std::vector<PointMatch> matches;  // from: pixels of the first, to: pixels of the second
};

// Finds matches between two pictures that may be shifted, turned and zoomed far against each other
// (8 bit, one channel, any sizes): ORB features and RANSAC first; then the second picture is warped
// onto the first by that homography and tracked as between consecutive frames (MetricTracks), so
// that the matches are as exact as tracks are. Matches within 3 px of the second picture's border
// are left out, since the warp had to invent what lies beyond. Empty when nothing agrees.
[[nodiscard]] std::optional<FrameAlignment> AlignFrames(const cv::Mat& first,
                                                        const cv::Mat& second);

}  // namespace rsstab::stabilizer::detail

#endif  // RSSTAB_STABILIZER_METRICS_FRAME_ALIGNMENT_DETAIL_H_
