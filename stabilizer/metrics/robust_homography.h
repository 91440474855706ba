// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_ROBUST_HOMOGRAPHY_H_
#define RSSTAB_STABILIZER_METRICS_ROBUST_HOMOGRAPHY_H_

#include <Eigen/Core>
#include <optional>
#include <span>

#include "igf/base/point_tracks.h"

namespace rsstab::stabilizer {

// Fewer matches than this tell nothing about a frame.
inline constexpr std::size_t kFewestMatches = 12;

// The homography `to_from_from` (h33 = 1) that explains most of the matches: RANSAC (3 px) for a
// start, then the minimum of sum log(1 + (e / scale_px)^2), e = |H from - to| in pixels. The scale
// decides how much a moving object or parallax pulls; 2.5 px is what the clip metrics use.
// Same input, same result. Empty with fewer than kFewestMatches matches, or when less than 30% of
// them lie within 3 px of the result (a scene cut), or when the result is singular.
[[nodiscard]] std::optional<Eigen::Matrix3d> RobustHomography(std::span<const PointMatch> matches,
                                                              double scale_px);

// The homography that minimises the plain sum of squares, from a start nearby. Empty as above.
[[nodiscard]] std::optional<Eigen::Matrix3d> LeastSquaresHomography(
    std::span<const PointMatch> matches, const Eigen::Matrix3d& start);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_ROBUST_HOMOGRAPHY_H_
