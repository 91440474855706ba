// SPDX-License-Identifier: Apache-2.0
// Real, shaky clips with damaged timestamps: every frame stays, in order, steadier than before.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/media/media_test_support.h"
#include "tests/end_to_end/program.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {
namespace {

// Share of pixels. The measurement aligns two pictures, and is off by a few pixels at an edge.
constexpr double kUndefinedNoise = 1e-4;

class RealClip : public ::testing::TestWithParam<const char*> {};

TEST_P(RealClip, IsSteadierAndComplete) {
  const auto clip = DevelopmentData(std::string("clips/") + GetParam());
  if (!clip) {
    GTEST_SKIP() << "development data clips/" << GetParam() << " is not there";
  }
  const TemporaryFolder folder;
  const std::string output = folder / "out.mkv";
  RunOrFail({clip->string(), "-o", output, "--preset", "ultrafast"});

  const auto before = media::testing::ReadClip(*clip);
  const auto after = media::testing::ReadClip(output);
  ASSERT_TRUE(before && after);
  ASSERT_EQ(after->frames.size(), before->frames.size());
  for (std::size_t i = 0; i < after->frames.size(); ++i) {
    // Matroska counts milliseconds.
    EXPECT_NEAR(after->frames[i].time_s - after->frames[0].time_s,
                before->frames[i].time_s - before->frames[0].time_s, 1.1e-3);
  }

  const nlohmann::json report =
      nlohmann::json::parse(RunOrFail({"compare", clip->string(), output, "--json"}).output);
  EXPECT_LT(report["output"]["jitter_px"], 0.5 * report["input"]["jitter_px"].get<double>());
  EXPECT_LT(report["output"]["shake_px"], 0.5 * report["input"]["shake_px"].get<double>());
  EXPECT_GE(report["pair"]["distortion_value"], 0.95);
  EXPECT_LT(report["pair"]["undefined_share"], kUndefinedNoise);
}

INSTANTIATE_TEST_SUITE_P(Shaky, RealClip, ::testing::Values("video-3.m4v", "video-8.m4v"),
                         [](const auto& clip) {
                           return "clip" + std::string(clip.param).substr(6, 1);
                         });

}  // namespace
}  // namespace rsstab::testing
