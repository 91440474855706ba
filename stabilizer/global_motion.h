// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_GLOBAL_MOTION_H_
#define RSSTAB_STABILIZER_GLOBAL_MOTION_H_

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rsstab::stabilizer {

// One scene point in two consecutive frames, normalised coordinates, rolling shutter and lens
// distortion already taken out.
struct RectifiedMatch {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
};

// How much of the motion the points could tell; each rung falls back to the next.
enum class MotionRung {
  kMesh,        // homography plus local motion of mesh cells
  kHomography,  // 8 degrees of freedom
  kSimilarity,  // shift, turn, zoom: few or badly spread points
  kHold,        // nothing to go by: the picture is taken to stand still
};

struct GlobalMotion {
  Eigen::Matrix3d to_from = Eigen::Matrix3d::Identity();  // earlier frame -> later frame, h33 = 1
  MotionRung rung = MotionRung::kHold;
  std::vector<bool> inlier;  // one per match: agrees with `to_from`
  int num_inliers = 0;
  double residual_px = 0.0;  // RMS over inliers, px at kReferenceWidthPx
};

struct GlobalMotionOptions {
  // What another sensor says, earlier -> later frame; the identity where there is none. The
  // estimate is a correction of it, and kHold returns it unchanged.
  Eigen::Matrix3d predicted = Eigen::Matrix3d::Identity();
  // The finest model for what `predicted` leaves: kHomography, or kSimilarity where a gyro already
  // tells the turn and a homography would only add the tracks' noise.
  MotionRung finest = MotionRung::kHomography;
};

// The motion that most points share: RANSAC, then iteratively reweighted least squares with a weak
// prior on what distinguishes a homography from a similarity, so that badly spread points bend
// nothing.
[[nodiscard]] GlobalMotion EstimateGlobalMotion(std::span<const RectifiedMatch> matches,
                                                const GlobalMotionOptions& options = {});

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_GLOBAL_MOTION_H_
