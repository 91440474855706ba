// SPDX-License-Identifier: Apache-2.0
#include "cli/media/output_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/test_paths.h"

namespace rsstab::media {
namespace {

namespace fs = std::filesystem;
using ::rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

std::string Slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

int Put(OutputFile& file, const std::string& text) {
  return file.Write(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

std::size_t Entries(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(OutputFile, AppearsWhenComplete) {
  const TemporaryFolder folder;
  auto file = OutputFile::Open((folder / "a.mp4").string(), false, "");
  ASSERT_TRUE(file);
  ASSERT_EQ(Put(**file, "hello"), 0);
  EXPECT_FALSE(fs::exists(folder / "a.mp4"));
  ASSERT_TRUE((*file)->Commit());
  EXPECT_EQ(Slurp(folder / "a.mp4"), "hello");
  EXPECT_EQ(Entries(folder.path()), 1U);
}

TEST(OutputFile, AbandonedFileIsRemoved) {
  const TemporaryFolder folder;
  {
    auto file = OutputFile::Open((folder / "a.mp4").string(), false, "");
    ASSERT_TRUE(file);
    ASSERT_EQ(Put(**file, "hello"), 0);
  }
  EXPECT_EQ(Entries(folder.path()), 0U);
}

TEST(OutputFile, ExistingFileNeedsOverwriteAndStaysUntilTheEnd) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.mp4") << "old";
  const auto refused = OutputFile::Open((folder / "a.mp4").string(), false, "");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("--overwrite"));
  auto file = OutputFile::Open((folder / "a.mp4").string(), true, "");
  ASSERT_TRUE(file);
  ASSERT_EQ(Put(**file, "new"), 0);
  EXPECT_EQ(Slurp(folder / "a.mp4"), "old");
  ASSERT_TRUE((*file)->Commit());
  EXPECT_EQ(Slurp(folder / "a.mp4"), "new");
}

TEST(OutputFile, FileMadeMeanwhileIsKept) {
  const TemporaryFolder folder;
  auto file = OutputFile::Open((folder / "a.mp4").string(), false, "");
  ASSERT_TRUE(file);
  std::ofstream(folder / "a.mp4") << "someone else's";
  ASSERT_FALSE((*file)->Commit());
  file->reset();
  EXPECT_EQ(Slurp(folder / "a.mp4"), "someone else's");
  EXPECT_EQ(Entries(folder.path()), 1U);
}

TEST(OutputFile, FollowsSymbolicLinks) {
  const TemporaryFolder folder;
  std::ofstream(folder / "real.mp4") << "old";
  fs::create_symlink("real.mp4", folder / "link.mp4");
  auto file = OutputFile::Open((folder / "link.mp4").string(), true, "");
  ASSERT_TRUE(file);
  ASSERT_EQ(Put(**file, "new"), 0);
  ASSERT_TRUE((*file)->Commit());
  EXPECT_TRUE(fs::is_symlink(folder / "link.mp4"));
  EXPECT_EQ(Slurp(folder / "real.mp4"), "new");
}

TEST(OutputFile, RefusesItsSourceAndFolders) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.mp4") << "film";
  fs::create_hard_link(folder / "a.mp4", folder / "b.mp4");
  const auto same =
      OutputFile::Open((folder / "b.mp4").string(), true, (folder / "a.mp4").string());
  ASSERT_FALSE(same);
  EXPECT_THAT(same.error().message, HasSubstr("same file"));
  const auto directory = OutputFile::Open(folder.path().string(), true, "");
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.error().message, HasSubstr("folder"));
  EXPECT_FALSE(OutputFile::Open("", true, ""));
}

TEST(OutputFile, MissingFolderIsNamed) {
  const TemporaryFolder folder;
  const auto refused = OutputFile::Open((folder / "there/a.mp4").string(), false, "");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(refused.error().message, HasSubstr("there"));
}

TEST(OutputFile, UnwritableFolderIsTold) {
  if (geteuid() == 0) {
    // root may write everywhere, except where nobody can.
    const auto refused = OutputFile::Open("/proc/a.mp4", false, "");
    EXPECT_FALSE(refused);
    return;
  }
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  const auto refused = OutputFile::Open((folder / "a.mp4").string(), false, "");
  fs::permissions(folder.path(), fs::perms::owner_all);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kIo);
  EXPECT_THAT(refused.error().message, HasSubstr("no permission"));
}

// A limit on file size fails like a full disk, in a place that all users have.
TEST(OutputFile, WriteErrorIsKeptUntilCommit) {
  const TemporaryFolder folder;
  struct rlimit usual {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &usual), 0);
  auto* const usual_handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit tight = usual;
  tight.rlim_cur = 1000;
  auto file = OutputFile::Open((folder / "a.mp4").string(), false, "");
  ASSERT_TRUE(file);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  const int first = Put(**file, std::string(5000, 'x'));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &usual), 0);
  static_cast<void>(std::signal(SIGXFSZ, usual_handler));
  EXPECT_LT(first, 0);
  EXPECT_EQ(Put(**file, "more"), first) << "nothing is written after a failure";
  const Status committed = (*file)->Commit();
  ASSERT_FALSE(committed);
  EXPECT_EQ(committed.error().code, ErrorCode::kIo);
  file->reset();
  EXPECT_EQ(Entries(folder.path()), 0U);
}

TEST(OutputFile, PipesAreWrittenDirectly) {
  const TemporaryFolder folder;
  const std::string fifo = (folder / "fifo").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  auto file = OutputFile::Open(fifo, false, "");
  ASSERT_TRUE(file) << "no --overwrite is needed";
  EXPECT_FALSE((*file)->can_seek());
  ASSERT_EQ(Put(**file, "hello"), 0);
  ASSERT_TRUE((*file)->Commit());
  char bytes[8] = {};
  EXPECT_EQ(read(reader, bytes, sizeof(bytes)), 5);
  close(reader);
  EXPECT_TRUE(fs::is_fifo(fifo));
}

TEST(OutputFile, NewFileHasTheUsualPermissions) {
  const TemporaryFolder folder;
  const mode_t usual = umask(022);
  auto file = OutputFile::Open((folder / "a.mp4").string(), false, "");
  umask(usual);
  ASSERT_TRUE(file);
  ASSERT_TRUE((*file)->Commit());
  EXPECT_EQ(fs::status(folder / "a.mp4").permissions(), static_cast<fs::perms>(0644));
}

}  // namespace
}  // namespace rsstab::media
