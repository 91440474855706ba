// SPDX-License-Identifier: Apache-2.0
#include "igf/base/staged_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "igf/base/whole_file.h"
#include "tests/support/test_paths.h"

namespace rsstab {
namespace {

namespace fs = std::filesystem;
using ::rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

std::string ReadText(const std::string& path) { return ReadWholeFile(path, 100).value_or(""); }

std::size_t Entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(StagedFile, NobodyElsesFileIsTouched) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.csv").string();
  std::ofstream(path + ".part") << "mine";
  auto one = StagedFile::Create(path);
  auto two = StagedFile::Create(path);
  ASSERT_TRUE(one && two);
  EXPECT_NE(one->current_path(), two->current_path());
  std::ofstream(one->current_path()) << "one";
  ASSERT_TRUE(one->Commit(false));
  EXPECT_EQ(ReadText(path), "one");
  const Status kept = two->Commit(false);
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(ReadText(path), "one");
  EXPECT_TRUE(two->Commit(true));
  EXPECT_EQ(ReadText(path + ".part"), "mine");
  EXPECT_EQ(Entries(folder.path()), 2U);
}

TEST(StagedFile, GoesWithItsOwner) {
  const TemporaryFolder folder;
  {
    auto first = StagedFile::Create((folder / "a").string());
    ASSERT_TRUE(first);
    StagedFile moved = std::move(*first);
    EXPECT_TRUE(fs::exists(moved.current_path()));
    auto second = StagedFile::Create((folder / "b").string());
    ASSERT_TRUE(second);
    moved = std::move(*second);
    EXPECT_EQ(Entries(folder.path()), 1U) << "the first went when it was replaced";
  }
  EXPECT_EQ(Entries(folder.path()), 0U);
}

TEST(StagedFile, SaysWhyNothingCanBeWritten) {
  const TemporaryFolder folder;
  const auto no_folder = StagedFile::Create((folder / "there/a").string());
  ASSERT_FALSE(no_folder);
  EXPECT_EQ(no_folder.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(no_folder.error().message, HasSubstr("there'; make it first"));
  const auto is_folder = StagedFile::Create(folder.path().string());
  ASSERT_FALSE(is_folder);
  EXPECT_EQ(is_folder.error().code, ErrorCode::kInvalidArgument);
  EXPECT_FALSE(StagedFile::Create(""));
  // A folder that is there, and takes no files from anybody.
  const auto nowhere = StagedFile::Create("/proc/a");
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, HasSubstr("takes no new file"));
}

TEST(WriteWholeFile, FollowsSymbolicLinks) {
  const TemporaryFolder folder;
  std::ofstream(folder / "real.json") << "old";
  fs::create_symlink("real.json", folder / "link.json");
  ASSERT_TRUE(WriteWholeFile((folder / "link.json").string(), std::string("new")));
  EXPECT_TRUE(fs::is_symlink(folder / "link.json"));
  EXPECT_EQ(ReadText((folder / "real.json").string()), "new");
}

TEST(WriteWholeFile, PipesStayPipes) {
  const TemporaryFolder folder;
  const std::string fifo = (folder / "fifo").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  EXPECT_TRUE(WriteWholeFile(fifo, std::string("hello")));
  char bytes[8] = {};
  EXPECT_EQ(read(reader, bytes, sizeof(bytes)), 5);
  close(reader);
  EXPECT_TRUE(fs::is_fifo(fifo));
  EXPECT_EQ(Entries(folder.path()), 1U);
}

}  // namespace
}  // namespace rsstab
