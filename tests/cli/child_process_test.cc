// SPDX-License-Identifier: Apache-2.0
#include "cli/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "igf/base/whole_file.h"
#include "tests/support/test_paths.h"

namespace rsstab::cli {
namespace {

using rsstab::testing::TemporaryFolder;
using ::testing::HasSubstr;

TEST(RunChild, BothStreamsComeBack) {
  const auto text = RunChild({"sh", "-c", "echo out; echo err >&2; cat"}, ".");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "out\nerr\n");  // and `cat` had nothing to read
}

TEST(RunChild, RunsInItsFolderWithoutAShell) {
  const TemporaryFolder folder;
  const std::string name = "a; $b";
  ASSERT_TRUE(WriteWholeFile((folder / name).string(), "text"));
  const auto text = RunChild({"cat", name}, folder.path());
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(*text, "text");
}

TEST(RunChild, FailuresAreTold) {
  const auto missing = RunChild({"no-such-program-of-this-name"}, ".");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("no-such-program-of-this-name"));

  const auto failed = RunChild({"sh", "-c", "echo first; echo the reason; exit 3"}, ".");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kIo);
  EXPECT_THAT(failed.error().message, HasSubstr("code 3: the reason"));

  const auto killed = RunChild({"sh", "-c", "kill -TERM $$"}, ".");
  ASSERT_FALSE(killed);
  EXPECT_THAT(killed.error().message, HasSubstr("signal 15"));
}

TEST(RunChild, MuchTextDoesNotBlock) {
  // More than a pipe holds.
  const auto text = RunChild({"sh", "-c", "yes 0123456789 | head -n 100000"}, ".");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(text->size(), 1'100'000U);
}

}  // namespace
}  // namespace rsstab::cli
