// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/report_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using ::testing::HasSubstr;

std::string Content(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(ReportFile, AppearsWhenItIsComplete) {
  const testing::TemporaryFolder folder;
  const auto path = folder / "out.html";
  auto file = ReportFile::Open(path.string(), false, {});
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_FALSE(std::filesystem::exists(path));
  const std::string html(3'000'000, 'x');
  ASSERT_TRUE(file->Write(html));
  EXPECT_EQ(Content(path), html);
}

TEST(ReportFile, LeavesNothingWithoutWriting) {
  const testing::TemporaryFolder folder;
  { ASSERT_TRUE(ReportFile::Open((folder / "out.html").string(), false, {})); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ReportFile, ReplacesOnlyWhenToldTo) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder / "out.html").string();
  std::ofstream(path) << "precious";
  const auto refused = ReportFile::Open(path, false, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("--overwrite"));
  EXPECT_EQ(Content(path), "precious");
  auto file = ReportFile::Open(path, true, {});
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->Write("new"));
  EXPECT_EQ(Content(path), "new");
}

TEST(ReportFile, TakesNoOtherFilesPlace) {
  const testing::TemporaryFolder folder;
  std::ofstream((folder / "clip.mp4").string()) << "film";
  const auto open = [&](const std::string& name, const std::string& other) {
    return ReportFile::Open((folder / name).string(), true, {(folder / other).string()});
  };
  EXPECT_EQ(open("clip.mp4", "clip.mp4").error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(open("./new", "new").error().code, ErrorCode::kInvalidArgument);  // not there yet
  std::filesystem::create_symlink(folder / "clip.mp4", folder / "link");
  EXPECT_EQ(open("link", "clip.mp4").error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(open("out.html", "clip.mp4"));
  EXPECT_FALSE(ReportFile::Open("./not-there-yet", true, {"not-there-yet"}));
  EXPECT_FALSE(ReportFile::Open("-", true, {}));
}

TEST(ReportFile, TellsOfAFullDevice) {
  auto file = ReportFile::Open("/dev/full", true, {});
  ASSERT_TRUE(file);
  const Status written = file->Write("text");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kIo);
  EXPECT_THAT(written.error().message, HasSubstr("/dev/full"));
}

}  // namespace
}  // namespace rsstab::cli
