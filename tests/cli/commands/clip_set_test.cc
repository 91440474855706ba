// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/clip_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "igf/base/whole_file.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using rsstab::testing::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void Touch(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  ASSERT_TRUE(WriteWholeFile(file.string(), "x"));
}

std::vector<std::string> NamesOf(const std::vector<EvaluationClip>& clips) {
  std::vector<std::string> names;
  for (const EvaluationClip& clip : clips) {
    names.push_back(std::string(ClipKindName(clip.kind)) + " " + clip.name);
  }
  return names;
}

TEST(FindClips, VideosAndSimulatedFoldersByName) {
  const TemporaryFolder folder;
  Touch(folder / "walk/rs.mp4");
  Touch(folder / "walk/truth.json");
  Touch(folder / "half/truth.json");  // to be told about, not to be overlooked
  Touch(folder / "photos/1.jpg");
  Touch(folder / "B.MOV");
  Touch(folder / "a.mp4");
  Touch(folder / "credits.txt");
  Touch(folder / ".hidden.mp4");
  const auto clips = FindClips(folder.path(), false);
  ASSERT_TRUE(clips) << clips.error().message;
  EXPECT_THAT(NamesOf(*clips),
              ElementsAre("real B.MOV", "real a.mp4", "simulated half", "simulated walk"));
  EXPECT_EQ(clips->back().video, folder / "walk/rs.mp4");
  EXPECT_EQ(clips->back().folder, folder / "walk");
  EXPECT_TRUE(clips->front().folder.empty());
}

TEST(FindClips, TwinsFollowTheirClips) {
  const TemporaryFolder folder;
  Touch(folder / "walk/rs.mp4");
  Touch(folder / "a.mp4");
  const auto clips = FindClips(folder.path(), true);
  ASSERT_TRUE(clips);
  EXPECT_THAT(NamesOf(*clips), ElementsAre("real a.mp4", "simulated walk", "twin walk/gs"));
  EXPECT_EQ(clips->back().video, folder / "walk/gs.mp4");
}

TEST(FindClips, ASimulatedFolderIsOneClip) {
  const TemporaryFolder folder;
  Touch(folder / "walk/rs.mp4");
  Touch(folder / "walk/gs.mp4");
  for (const char* written : {"walk", "walk/", "walk/."}) {
    const auto clips = FindClips(folder / written, false);
    ASSERT_TRUE(clips);
    EXPECT_THAT(NamesOf(*clips), ElementsAre("simulated walk")) << written;
  }
}

TEST(FindClips, AFolderWithoutClipsIsAnError) {
  const TemporaryFolder folder;
  Touch(folder / "credits.txt");
  const auto none = FindClips(folder.path(), false);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(none.error().message, HasSubstr("there is no clip in this folder"));
  const auto missing = FindClips("/nonexistent", false);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("/nonexistent"));
}

}  // namespace
}  // namespace rsstab::cli
