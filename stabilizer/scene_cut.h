// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_SCENE_CUT_H_
#define RSSTAB_STABILIZER_SCENE_CUT_H_

#include "stabilizer/luma_proxy.h"

namespace rsstab::stabilizer {

// What two neighbouring pictures have in common.
struct SceneChangeEvidence {
  double fingerprint_distance = 0.0;  // FingerprintDistance, 8-bit levels
  int attempted_points = 0;           // points looked for in the later picture
  int consistent_points = 0;          // of those, found and agreeing on one motion
};

// True where a camera path must end and another begin: the points are lost AND the picture looks
// different. A whip pan loses points but keeps its brightness; a flash changes brightness but keeps
// its points; a textureless picture has no points to lose.
[[nodiscard]] bool IsSceneCut(const SceneChangeEvidence& evidence);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_SCENE_CUT_H_
