// SPDX-License-Identifier: Apache-2.0
// A drone's clip carries its gyro log: the rotation that is found without it has to be the logged
// one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "evaluation/path_angle_score.h"
#include "tests/end_to_end/program.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

constexpr double kFrameS = 1001.0 / 30000.0;
// By the pan in the log against that in the picture, px.
constexpr int kFocal = 556;
// 0.3 px from frame to frame at that focal length, in degrees/s: three times the noise of a track.
// The clip shows waves, and propellers shake the sensor at 160 Hz but hardly the picture.
constexpr double kRateTolerance = 0.3 / kFocal / kFrameS * 180.0 / std::numbers::pi;
// The camera turns at 4.9 degrees/s, mostly in one pan.
constexpr double kLeastRate = 4.0;

TEST(LoggedRotation, IsFoundWithoutTheLog) {
  const auto clip = DevelopmentData("clips/karma.mp4");
  if (!clip) {
    GTEST_SKIP() << "development data clips/karma.mp4 is not there";
  }
  const TemporaryFolder folder;
  const auto path_of = [&](const std::string& rs, const std::string& name) {
    const std::string file = folder / name;
    // What the clip does not tell is given: its focal length, and any readout, since middle rows
    // are compared.
    RunOrFail({"analyze", clip->string(), "-o", file, "--rs", rs, "--focal", std::to_string(kFocal),
               "--readout", "15"});
    return evaluation::ReadOrientationPath(file);
  };
  const auto logged = path_of("gyro", "logged");
  const auto found = path_of("fused", "found");
  ASSERT_TRUE(logged && found);
  const auto score = evaluation::ScorePathAngle(*found, *logged, kFrameS);
  ASSERT_TRUE(score) << score.error().message;
  EXPECT_GT(score->known_share, 0.98);
  EXPECT_GT(score->uncorrected_rate_deg_s.value(), kLeastRate);
  // Less the log's bias, which no picture has (0.9 degrees/s, most of it taken out before).
  const double drift = score->drift_axes_deg_s->norm();
  EXPECT_LT(drift, 1.0);
  EXPECT_LT(std::sqrt(*score->rate_deg_s * *score->rate_deg_s - drift * drift), kRateTolerance);
  // Turned the other way round it would be wrong twice over.
  evaluation::OrientationPath reversed = *found;
  for (auto& orientation : reversed) {
    if (orientation) {
      orientation->camera_from_world = orientation->camera_from_world.conjugate();
    }
  }
  EXPECT_GT(evaluation::ScorePathAngle(reversed, *logged, kFrameS)->rate_deg_s.value(),
            2.0 * kLeastRate);
}

}  // namespace
}  // namespace rsstab::testing
