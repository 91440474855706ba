// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_PLUGIN_FREI0R_HOST_PROGRAMS_H_
#define RSSTAB_TESTS_PLUGIN_FREI0R_HOST_PROGRAMS_H_

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tests/support/test_paths.h"

namespace rsstab::frei0r::testing {

// A folder with a shaky clip, its analysis file and what the program makes of both, and the hosts'
// programs to compare with. The plugin that was built is the one they find.
class HostPrograms : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  // Makes NAME.mkv (mpeg4), NAME.rsstab and NAME-cli.mkv (FFV1).
  void MakeClip(const std::string& name, int width, int height, int frames = 40);

  // Stock ffmpeg; its standard error. A failure of it is a failure of the test.
  std::string FFmpeg(std::vector<std::string> arguments);
  // `input` through `filters` to `output`, FFV1 with the chroma of the input.
  std::string Filter(const std::string& input, const std::string& filters,
                     const std::string& output);
  // PSNR of two clips, all planes and frames, dB; infinity when they are the same.
  double Psnr(const std::string& a, const std::string& b);
  // MD5 of each RGBA frame that `filters` make of `input`.
  std::string FrameHashes(const std::string& input, const std::string& filters);
  // melt, with `arguments`.
  std::string Melt(const std::vector<std::string>& arguments);

  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }

 private:
  rsstab::testing::TemporaryFolder folder_;
};

[[nodiscard]] int CountOf(const std::string& text, const std::string& words);

}  // namespace rsstab::frei0r::testing

// A test that cannot run says why.
#define RSSTAB_NEEDS_FFMPEG()                                              \
  if (std::string(RSSTAB_FFMPEG).empty()) {                                \
    GTEST_SKIP() << "ffmpeg was not found when the tests were configured"; \
  }
#define RSSTAB_NEEDS_MELT()                                              \
  RSSTAB_NEEDS_FFMPEG()                                                  \
  if (std::string(RSSTAB_MELT).empty()) {                                \
    GTEST_SKIP() << "melt was not found when the tests were configured"; \
  }

#endif  // RSSTAB_TESTS_PLUGIN_FREI0R_HOST_PROGRAMS_H_
