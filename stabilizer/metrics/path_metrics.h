// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_PATH_METRICS_H_
#define RSSTAB_STABILIZER_METRICS_PATH_METRICS_H_

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace rsstab::stabilizer {

// How steadily a clip moves. `motions[n]` takes pixels of frame n to frame n + 1 (width x height
// pixels, centres at integers); empty where it could not be measured. Any thread.
//
// The picture's path is the running sum of what the motions do to the picture's centre, its angle
// the running sum of their rotation there (of the Jacobian, by polar decomposition). Sums, not
// products of homographies: the same within 1% over the test clips, and never degenerate.
// Unmeasured motions count as none.
using MotionList = std::span<const std::optional<Eigen::Matrix3d>>;

// Jitter, px at 640 px width: root mean square length of the change of the image motion from one
// frame to the next (the path's second difference), over a 5x5 grid that spans 10% to 90% of each
// side. Empty when no two motions in a row are known.
[[nodiscard]] std::optional<double> Jitter(MotionList motions, int width, int height);

// Shake, px at 640 px width: root mean square length of the path less its Gaussian mean over 0.25 s
// (cut off at three standard deviations, renormalised at the ends); 0.4 s at either end are left
// out when the clip is longer than three times that. `frames_per_second` > 0. Empty below 3
// motions.
[[nodiscard]] std::optional<double> Shake(MotionList motions, int width, int height,
                                          double frames_per_second);

// Stability of Liu et al. 2013, section 5.1: the share of the path's spectral energy (squared
// magnitude, lower half of the spectrum, constant part left out) that lies in the 2nd to 6th
// frequency (the constant part being the 1st). In [0, 1], 1 = steady; a path without any movement
// has 1. Translation adds up the energies of x and y.
struct Stability {
  double translation = 1.0;
  double rotation = 1.0;
};
// Empty below 12 motions.
[[nodiscard]] std::optional<Stability> PathStability(MotionList motions, int width, int height);

// Where the picture's content stands against the first frame: the path above, and the product of
// the scales at the picture's centre.
struct PicturePose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // px at 640 px width
  double angle_rad = 0.0;                              // x towards y
  double scale = 1.0;
};
// One pose a frame, that is, one more than motions.
[[nodiscard]] std::vector<PicturePose> PicturePath(MotionList motions, int width, int height);

// Rotation (rad, x towards y) and uniform scale of what a homography does near a pixel.
struct LocalSimilarity {
  double angle_rad = 0.0;
  double scale = 1.0;  // root of the area ratio
};
[[nodiscard]] LocalSimilarity SimilarityAt(const Eigen::Matrix3d& homography,
                                           const Eigen::Vector2d& pixel);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_PATH_METRICS_H_
