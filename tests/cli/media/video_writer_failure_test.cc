// SPDX-License-Identifier: Apache-2.0
// What VideoWriter refuses, and what it leaves behind when something fails: nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/media/video_writer.h"
#include "tests/cli/media/media_test_support.h"
#include "tests/support/test_paths.h"

namespace rsstab::media {
namespace {

using ::rsstab::testing::TemporaryFolder;
using ::testing::AllOf;
using testing::ClipRecipe;
using testing::CopyClip;
using testing::FilesIn;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeClip;
using ::testing::Not;
using testing::ReadClip;
using testing::SmallRecipe;
using testing::TestPicture;

TEST(VideoWriterFailure, RefusesBadOptions) {
  const TemporaryFolder folder;
  const auto refusal = [&folder](const auto& change, const char* file = "a.mp4") {
    ClipRecipe recipe = SmallRecipe();
    change(recipe);
    const Status made = MakeClip(folder / file, recipe);
    return made ? std::string() : made.error().message;
  };
  EXPECT_THAT(refusal([](ClipRecipe& r) {
                r.options.encoder_options = {{"speling", "1"}};
              }),
              HasSubstr("'speling'"));
  EXPECT_THAT(refusal([](ClipRecipe& r) {
                r.options.muxer_options = {{"speling", "1"}};
              }),
              HasSubstr("'speling'"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.options.preset = "quick"; }), HasSubstr("'quick'"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.options.crf = 99; }), HasSubstr("99"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.options.codec = "h266"; }), HasSubstr("h266"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.options.codec = "ffv1"; }), HasSubstr("cannot hold"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.options.format = "mp5"; }), HasSubstr("'mp5'"));
  // What it says can be done: there is no option that names a container.
  EXPECT_THAT(refusal([](ClipRecipe&) {}, "noextension"),
              AllOf(HasSubstr(".mp4, .mov, .mkv or .webm"), Not(HasSubstr("--"))));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.description.width = 20000; }), HasSubstr("20000"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.description.height = 0; }), HasSubstr("96x0"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.description.frame_rate = {0, 1}; }), HasSubstr("0/1"));
  EXPECT_THAT(refusal([](ClipRecipe& r) { r.times = {5, 6, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}; }),
              HasSubstr("frame 2"));
  EXPECT_THAT(FilesIn(folder.path()), IsEmpty()) << "nothing is left behind";
}

TEST(VideoWriterFailure, RefusesFramesOfAnotherSize) {
  const TemporaryFolder folder;
  const ClipRecipe recipe = SmallRecipe();
  auto writer =
      VideoWriter::Create((folder / "a.mp4").string(), recipe.description, recipe.options);
  ASSERT_TRUE(writer);
  const Status wrong = (*writer)->Write(TestPicture(Yuv420Layout(), 32, 72, 0));
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kInvalidArgument);
}

TEST(VideoWriterFailure, AbandonedWriteLeavesNothing) {
  const TemporaryFolder folder;
  const ClipRecipe recipe = SmallRecipe();
  {
    auto writer =
        VideoWriter::Create((folder / "a.mp4").string(), recipe.description, recipe.options);
    ASSERT_TRUE(writer);
    ASSERT_TRUE((*writer)->Write(TestPicture(Yuv420Layout(), 96, 72, 0)));
    const std::vector<std::string> during = FilesIn(folder.path());
    ASSERT_EQ(during.size(), 1U);
    EXPECT_EQ(during[0].front(), '.') << "hidden until complete";
  }
  EXPECT_THAT(FilesIn(folder.path()), IsEmpty());
}

TEST(VideoWriterFailure, FullDiskIsToldAndNothingIsLeft) {
  // /dev/full takes no byte; it is a device, so it is written to directly.
  ClipRecipe recipe = SmallRecipe();
  recipe.options.format = "matroska";
  recipe.frames = 30;
  const Status full = MakeClip("/dev/full", recipe);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kIo);
  EXPECT_THAT(full.error().message, HasSubstr("disk is full"));
}

// A limit on the size of files fails as a full disk does, on a regular file.
TEST(VideoWriterFailure, WriteErrorsSurfaceAndTheHiddenFileGoes) {
  const TemporaryFolder folder;
  struct rlimit usual {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &usual), 0);
  auto* const usual_handler = std::signal(SIGXFSZ, SIG_IGN);
  for (const char* name : {"a.mp4", "a.mkv"}) {
    struct rlimit tight = usual;
    tight.rlim_cur = 2000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
    const Status made = MakeClip(folder / name, SmallRecipe());
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &usual), 0);
    ASSERT_FALSE(made) << name;
    EXPECT_EQ(made.error().code, ErrorCode::kIo);
    EXPECT_THAT(made.error().message, HasSubstr(name));
    EXPECT_THAT(made.error().message, HasSubstr("larger than the system allows"));
  }
  static_cast<void>(std::signal(SIGXFSZ, usual_handler));
  EXPECT_THAT(FilesIn(folder.path()), IsEmpty());
}

TEST(VideoWriterFailure, RefusesToWriteOverItsInput) {
  const TemporaryFolder folder;
  ASSERT_TRUE(MakeClip(folder / "a.mp4", SmallRecipe()));
  std::filesystem::create_hard_link(folder / "a.mp4", folder / "b.mp4");
  std::filesystem::create_symlink(folder / "a.mp4", folder / "c.mp4");
  WriterOptions options;
  options.overwrite = true;
  for (const char* name : {"a.mp4", "b.mp4", "c.mp4"}) {
    const auto refused = CopyClip(folder / "a.mp4", folder / name, options);
    ASSERT_FALSE(refused) << name;
    EXPECT_THAT(refused.error().message, HasSubstr("same file"));
  }
  EXPECT_TRUE(ReadClip(folder / "a.mp4"));
}

TEST(VideoWriterFailure, FinishedClipCannotBeWrittenTo) {
  const TemporaryFolder folder;
  const ClipRecipe recipe = SmallRecipe();
  auto writer =
      VideoWriter::Create((folder / "a.mp4").string(), recipe.description, recipe.options);
  ASSERT_TRUE(writer);
  const Frame picture = TestPicture(Yuv420Layout(), 96, 72, 0);
  ASSERT_TRUE((*writer)->Write(picture));
  ASSERT_TRUE((*writer)->Finish());
  EXPECT_FALSE((*writer)->Write(picture));
  EXPECT_FALSE((*writer)->Finish());
}

}  // namespace
}  // namespace rsstab::media
