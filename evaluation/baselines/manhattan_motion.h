// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_BASELINES_MANHATTAN_MOTION_H_
#define RSSTAB_EVALUATION_BASELINES_MANHATTAN_MOTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>

#include "igf/base/camera.h"
#include "igf/base/result.h"

namespace rsstab::evaluation {

// A straight piece of an edge in the recorded picture, px.
struct EdgeSegment {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  [[nodiscard]] double Length() const { return (b - a).norm(); }
};

// camera_row_from_middle = exp([rate s + change s^2]x), s from -0.5 to 0.5 down the rows; rad.
struct RowMotion {
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
  int inliers = 0;  // segments that lead to one of the three vanishing points
  [[nodiscard]] Eigen::Quaterniond AtRow(double row, int height) const;
};

// The motion under which the segments of a Manhattan scene lead to three vanishing points at right
// angles, and pieces of one bent edge become straight (see straight_lines.h for the papers).
// The vanishing points come from a seeded search over triples of segments; motion and vanishing
// points are then refined together (Ceres, Cauchy loss), segments being assigned anew in between.
// Errors: kUntrustworthy when fewer than two directions have enough segments, or the segments do
// not outnumber what a random picture would give.
[[nodiscard]] Result<RowMotion> FitManhattanMotion(std::span<const EdgeSegment> segments,
                                                   const Camera& camera, std::uint64_t seed);

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_BASELINES_MANHATTAN_MOTION_H_
