// SPDX-License-Identifier: Apache-2.0
// What can go wrong with the filters rsanalyze and rsstabilize inside ffmpeg, and what must not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/end_to_end/program.h"
#include "tests/plugin/ffmpeg/ffmpeg_program.h"
#include "tests/support/test_clip.h"

namespace rsstab::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kFrames = 16;
constexpr const char* kValgrind = "/usr/bin/valgrind";

class NativeFilterFailure : public FfmpegTest {
 protected:
  void SetUp() override {
    FfmpegTest::SetUp();
    if (!IsSkipped() && !HasFatalFailure()) {
      TestClip clip;
      clip.frames = kFrames;
      WriteTestClip(Path("clip.mkv"), clip);
    }
  }

  // Failure, a sentence with these words, and no frame written.
  void ExpectRefused(const std::string& filter, const std::string& words) {
    const ProgramResult run =
        Ffmpeg({"-i", "clip.mkv", "-vf", filter, "-f", "framecrc", "out.txt"});
    EXPECT_GT(run.exit_code, 0) << filter;
    EXPECT_THAT(run.error, HasSubstr(words)) << filter;
    EXPECT_THAT(ReadText(Path("out.txt")), Not(HasSubstr("0, "))) << filter;
  }
};

TEST_F(NativeFilterFailure, FilesThatCannotBeUsedEndWithASentence) {
  ExpectRefused("rsstabilize=nowhere.rsstab", "nowhere.rsstab");

  FfmpegOrFail({"-i", "clip.mkv", "-vf", "rsanalyze=clip.rsstab", "-f", "null", "-"});
  const std::string whole = ReadText(Path("clip.rsstab"));
  std::ofstream(Path("half.rsstab"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  ExpectRefused("rsstabilize=half.rsstab", "half.rsstab");
  std::ofstream(Path("empty.rsstab"), std::ios::binary) << "";
  ExpectRefused("rsstabilize=empty.rsstab", "empty.rsstab");
  ExpectRefused("rsanalyze=" + Path("no/such/folder/clip.rsstab"), "no/such/folder");
  // Another shape than the one that was analysed.
  ExpectRefused("scale=160:60,rsstabilize=clip.rsstab", "clip.rsstab");
}

TEST_F(NativeFilterFailure, OptionsAreCheckedByTheLibrary) {
  ExpectRefused("rsstabilize=crop=7", "crop");
  ExpectRefused("rsstabilize=lookahead=many", "lookahead");
  ExpectRefused("rsstabilize=opts=nonsense=1", "nonsense");
  ExpectRefused("rsstabilize=opts=nonsense", "opts: 'nonsense'");
  ExpectRefused("rsanalyze=rs=magic", "magic");
}

TEST_F(NativeFilterFailure, FailedAnalysisLeavesTheOldFileAlone) {
  std::ofstream(Path("clip.rsstab")) << "old";
  ExpectRefused("rsanalyze=clip.rsstab:rs=gyro", "gyro");
  EXPECT_EQ(ReadText(Path("clip.rsstab")), "old");
}

TEST_F(NativeFilterFailure, NoFramesAreNoFailure) {
  for (const char* filter : {"rsanalyze=none.rsstab", "rsstabilize=lookahead=5"}) {
    FfmpegOrFail(
        {"-i", "clip.mkv", "-vf", std::string("trim=end_frame=0,") + filter, "-f", "null", "-"});
  }
  EXPECT_FALSE(std::filesystem::exists(Path("none.rsstab")));
}

TEST_F(NativeFilterFailure, StoppedEarlyTheAnalysisIsOfTheFramesSoFar) {
  for (const char* limit : {"-t", "-frames:v"}) {
    const std::string amount = limit == std::string("-t") ? "0.3" : "7";
    std::filesystem::remove(Path("part.rsstab"));
    FfmpegOrFail(
        {"-i", "clip.mkv", "-vf", "rsanalyze=part.rsstab", limit, amount, "-f", "null", "-"});
    EXPECT_TRUE(std::filesystem::exists(Path("part.rsstab"))) << limit;
  }
}

TEST_F(NativeFilterFailure, FramesThatTheFileDoesNotKnowGoThrough) {
  FfmpegOrFail({"-t", "0.3", "-i", "clip.mkv", "-vf", "rsanalyze=part.rsstab", "-f", "null", "-"});
  // What follows looks like nothing that was analysed.
  const std::string other = "negate=enable='gte(t,0.29)'";
  const ProgramResult run = FfmpegOrFail(
      {"-i", "clip.mkv", "-vf", other + ",rsstabilize=part.rsstab", "-f", "null", "-"});
  EXPECT_THAT(run.error, HasSubstr("7 of 16 frames are not in part.rsstab"));
  const std::vector<std::string> before = FrameList({"-i", "clip.mkv"}, other);
  const std::vector<std::string> after =
      FrameList({"-i", "clip.mkv"}, other + ",rsstabilize=part.rsstab");
  ASSERT_EQ(before.size(), static_cast<std::size_t>(kFrames));
  ASSERT_EQ(after.size(), before.size());
  EXPECT_NE(after.front(), before.front());
  EXPECT_EQ(after.back(), before.back());
}

TEST_F(NativeFilterFailure, SizeThatChangesInMidStream) {
  // scale changes its output, and the filter behind it gets frames of another size.
  const std::string change = "sendcmd=c='0.2 scale w 128;0.2 scale h 96',scale=160:120:eval=frame,";
  const std::vector<std::string> frames =
      FrameList({"-i", "clip.mkv"}, change + "rsstabilize=lookahead=5");
  const std::vector<std::string> expected = FrameList({"-i", "clip.mkv"}, change + "null");
  ASSERT_EQ(frames.size(), expected.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {  // all but the checksum
    EXPECT_EQ(frames[i].substr(0, frames[i].rfind(',')),
              expected[i].substr(0, expected[i].rfind(',')));
  }
  const ProgramResult run = Ffmpeg(
      {"-i", "clip.mkv", "-vf", change + "rsanalyze=clip.rsstab", "-f", "framecrc", "out.txt"});
  EXPECT_GT(run.exit_code, 0);
  EXPECT_THAT(run.error, HasSubstr("128x96 after 160x120"));
  EXPECT_FALSE(std::filesystem::exists(Path("clip.rsstab")));
}

TEST_F(NativeFilterFailure, NoLeaksAndNoBadMemory) {
  if (!std::filesystem::exists(kValgrind)) {
    GTEST_SKIP() << "valgrind is not installed";
  }
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"-vf", "rsanalyze=clip.rsstab"},
        {"-vf", "rsstabilize=clip.rsstab"},
        {"-vf", "rsstabilize=lookahead=5"},
        {"-vf", "rsstabilize=lookahead=50", "-t", "0.2"},
        {"-vf", "rsstabilize=nowhere.rsstab"},
        {"-vf", "rsstabilize=opts=mesh=4x4|nonsense=1"}}) {
    std::vector<std::string> all = {"--quiet",
                                    "--error-exitcode=99",
                                    "--leak-check=full",
                                    "--errors-for-leak-kinds=definite,indirect",
                                    "--show-leak-kinds=definite,indirect",
                                    program().string(),
                                    "-hide_banner",
                                    "-nostdin",
                                    "-loglevel",
                                    "error",
                                    "-i",
                                    "clip.mkv"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"-f", "null", "-"});
    ProgramSettings settings;
    settings.folder = std::filesystem::path(Path("clip.mkv")).parent_path();
    settings.timeout_s = 600.0;
    const ProgramResult run = RunProgram(kValgrind, all, settings);
    EXPECT_FALSE(run.timed_out);
    EXPECT_NE(run.exit_code, 99) << arguments[1] << "\n" << run.error;
  }
}

TEST_F(NativeFilterFailure, CompilesForTheNextReleases) {
  for (const char* suite : {"trixie"}) {
    const ProgramResult run =
        BuildFfmpeg({"--suite", suite, "--only", "libavfilter/vf_rsstabilize.o"},
                    std::string("ffmpeg-") + suite,
                    {"--disable-everything", "--disable-autodetect", "--disable-x86asm",
                     "--enable-filter=rsanalyze,rsstabilize"});
    EXPECT_EQ(run.exit_code, 0) << run.error;
  }
}

}  // namespace
}  // namespace rsstab::testing
