// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_BENCH_SYNTHETIC_MATCHES_H_
#define RSSTAB_BENCH_SYNTHETIC_MATCHES_H_

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

#include "igf/base/homography.h"
#include "igf/base/seeded_random.h"
#include "stabilizer/global_motion.h"
#include "stabilizer/normalized_coordinates.h"

namespace rsstab::bench {

inline constexpr double kAspect = 0.5625;
// A textured 16:9 frame has about this many tracks: most of the 576 cells of its proxy.
inline constexpr int kMatchesPerFrame = 500;

// Turn, shift and a little perspective from one frame to the next.
[[nodiscard]] inline Eigen::Matrix3d FrameToFrame() {
  Eigen::Matrix3d h;
  h << 1.0, -0.004, 0.012, 0.004, 1.0, -0.008, 0.01, 0.0, 1.0;
  return h;
}

// Matches of that motion with parallax of 1.5 px, 0.1 px of noise and a fifth of wrong ones.
[[nodiscard]] inline std::vector<stabilizer::RectifiedMatch> SyntheticMatches() {
  constexpr double kPx = 1.0 / stabilizer::kReferenceWidthPx;
  SeededRandom random(1);
  std::vector<stabilizer::RectifiedMatch> matches;
  for (int i = 0; i < kMatchesPerFrame; ++i) {
    stabilizer::RectifiedMatch m;
    m.from = {random.Uniform(-0.5, 0.5), kAspect * random.Uniform(-0.5, 0.5)};
    const Eigen::Vector2d parallax(1.5 * kPx * std::sin(2.0 * std::numbers::pi * m.from.x()), 0.0);
    const Eigen::Vector2d noise(0.1 * kPx * random.Normal(), 0.1 * kPx * random.Normal());
    m.to = Project(FrameToFrame(), m.from) + parallax + noise;
    if (i % 5 == 0) {
      m.to = {random.Uniform(-0.5, 0.5), kAspect * random.Uniform(-0.5, 0.5)};
    }
    matches.push_back(m);
  }
  return matches;
}

}  // namespace rsstab::bench

#endif  // RSSTAB_BENCH_SYNTHETIC_MATCHES_H_
