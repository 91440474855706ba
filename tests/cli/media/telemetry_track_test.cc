// SPDX-License-Identifier: Apache-2.0
#include "cli/media/telemetry_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/cli/media/media_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::media {
namespace {

using ::rsstab::testing::DevelopmentData;
using ::rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

TEST(TelemetryTrack, GivesBytesAndTimes) {
  const TemporaryFolder folder;
  testing::ClipRecipe clip = testing::SmallRecipe();
  clip.frames = 75;
  ASSERT_TRUE(testing::MakeClip(folder / "a.mp4", clip));
  testing::RemuxRecipe recipe;
  recipe.with_data = true;
  Remux(folder / "a.mp4", folder / "b.mp4", recipe);
  const auto payloads = ReadTelemetry((folder / "b.mp4").string(), "gpmd");
  ASSERT_TRUE(payloads) << payloads.error().message;
  ASSERT_EQ(payloads->size(), 3U);
  for (std::size_t i = 0; i < payloads->size(); ++i) {
    EXPECT_EQ((*payloads)[i].bytes.size(), 64U);
    EXPECT_NEAR((*payloads)[i].start_s, static_cast<double>(i), 1e-3);
    EXPECT_NEAR((*payloads)[i].duration_s, 1.0, 1e-3);
  }
  const auto absent = ReadTelemetry((folder / "b.mp4").string(), "camm");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(absent.error().message, HasSubstr("'camm'"));
  EXPECT_FALSE(ReadTelemetry((folder / "c.mp4").string(), "gpmd"));
}

TEST(TelemetryTrack, RealGoProTrack) {
  const auto karma = DevelopmentData("clips/karma.mp4");
  const auto first = DevelopmentData("gyro/karma.raw");
  if (!karma || !first) {
    GTEST_SKIP() << "the development clips are not there";
  }
  const auto payloads = ReadTelemetry(karma->string(), "gpmd");
  ASSERT_TRUE(payloads) << payloads.error().message;
  ASSERT_EQ(payloads->size(), 13U);
  std::ifstream file(*first, std::ios::binary);
  const std::vector<std::uint8_t> expected{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(payloads->front().bytes, expected);
  for (std::size_t i = 0; i < payloads->size(); ++i) {
    EXPECT_NEAR((*payloads)[i].start_s, 1.001 * static_cast<double>(i), 1e-9);
  }
}

}  // namespace
}  // namespace rsstab::media
