// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/scene_cut.h"

namespace rsstab::stabilizer {
namespace {

// Measured on the shaky clips and on whip pans: neighbours keep above 55% of their points;
// unrelated pictures keep below 8% by chance.
constexpr double kMinKeptShare = 0.2;
// Neighbouring frames of one shot differ by less than 8 levels even in a whip pan of 40 px a frame;
// unrelated pictures by 25 and more.
constexpr double kDifferentPicture = 14.0;
// Without points there is only the look to judge by.
constexpr int kFewPoints = 12;
constexpr double kVeryDifferentPicture = 30.0;

}  // namespace

bool IsSceneCut(const SceneChangeEvidence& evidence) {
  if (evidence.attempted_points < kFewPoints) {
    return evidence.fingerprint_distance > kVeryDifferentPicture;
  }
  const double kept = static_cast<double>(evidence.consistent_points) /
                      static_cast<double>(evidence.attempted_points);
  return kept < kMinKeptShare && evidence.fingerprint_distance > kDifferentPicture;
}

}  // namespace rsstab::stabilizer
