// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_PLUGIN_FFMPEG_FFMPEG_PROGRAM_H_
#define RSSTAB_TESTS_PLUGIN_FFMPEG_FFMPEG_PROGRAM_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {

// Tests with the native filter inside a real ffmpeg. They fetch FFmpeg's sources through apt and
// build them (two minutes the first time), so they run only with RSSTAB_TEST_FFMPEG=1. What was
// built is kept in $RSSTAB_FFMPEG_CACHE, else below the user's cache folder.
class FfmpegTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  void SetUp() override;

  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }

  // ffmpeg with these arguments, in the test's folder.
  [[nodiscard]] ProgramResult Ffmpeg(const std::vector<std::string>& arguments) const;
  // The same; ending in failure is a failure of the test.
  ProgramResult FfmpegOrFail(const std::vector<std::string>& arguments) const;
  // One line per frame that comes out of `filters`: times, duration, size and checksum.
  std::vector<std::string> FrameList(const std::vector<std::string>& input,
                                     const std::string& filters) const;

  [[nodiscard]] static const std::filesystem::path& program();

 private:
  TemporaryFolder folder_;
};

// Runs build_ffmpeg.sh with FOLDER below the cache and librsstab of this build.
[[nodiscard]] ProgramResult BuildFfmpeg(const std::vector<std::string>& settings,
                                        const std::string& folder,
                                        const std::vector<std::string>& options);

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_PLUGIN_FFMPEG_FFMPEG_PROGRAM_H_
