// SPDX-License-Identifier: Apache-2.0
// The plugin inside stock ffmpeg: as docs/plugins.md says it is used.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/plugin/frei0r/host_programs.h"

namespace rsstab::frei0r::testing {
namespace {

using ::testing::HasSubstr;

// The way to RGB and back costs that much: what is asked of two-pass use.
constexpr double kSameFrames_db = 45.0;
// Frames that are off by one, or not stabilised, are far below.
constexpr double kOtherFrames_db = 35.0;

class FFmpegTest : public HostPrograms {
 protected:
  static std::string Plugin(const std::string& parameters) {
    return "frei0r=filter_name=rsstabilize:filter_params=" + parameters;
  }
};

TEST_F(FFmpegTest, TwoPassGivesTheProgramsFrames) {
  RSSTAB_NEEDS_FFMPEG();
  MakeClip("clip", 320, 240);
  Filter(Path("clip.mkv"), Plugin(Path("clip.rsstab")), Path("out.mkv"));
  EXPECT_GT(Psnr(Path("out.mkv"), Path("clip-cli.mkv")), kSameFrames_db);
  EXPECT_LT(Psnr(Path("clip.mkv"), Path("clip-cli.mkv")), kOtherFrames_db);
}

// FFmpeg pads the rows of such pictures and loses their times.
TEST_F(FFmpegTest, TwoPassGivesTheProgramsFramesAtAnyWidth) {
  RSSTAB_NEEDS_FFMPEG();
  for (const int width : {200, 214, 333}) {
    SCOPED_TRACE(width);
    MakeClip("clip", width, 150);
    const std::string said = Filter(Path("clip.mkv"), Plugin(Path("clip.rsstab")), Path("out.mkv"));
    EXPECT_EQ(CountOf(said, "rsstabilize:"), 0) << said;
    EXPECT_GT(Psnr(Path("out.mkv"), Path("clip-cli.mkv")), kSameFrames_db);
    std::filesystem::remove(Path("clip.rsstab"));
    std::filesystem::remove(Path("clip-cli.mkv"));
  }
}

TEST_F(FFmpegTest, AMissingFilePassesThroughAndSaysSoOnce) {
  RSSTAB_NEEDS_FFMPEG();
  for (const int width : {320, 214}) {
    SCOPED_TRACE(width);
    MakeClip("clip", width, 150, 10);
    const std::string before = FrameHashes(Path("clip.mkv"), "format=rgba");
    const std::string after =
        FrameHashes(Path("clip.mkv"), "format=rgba," + Plugin("/nowhere/clip.rsstab"));
    EXPECT_EQ(before, after);
    const std::string said =
        Filter(Path("clip.mkv"), Plugin("/nowhere/clip.rsstab"), Path("out.mkv"));
    EXPECT_EQ(CountOf(said, "rsstabilize:"), 1) << said;
    EXPECT_THAT(said, HasSubstr("/nowhere/clip.rsstab"));
    std::filesystem::remove(Path("clip.rsstab"));
    std::filesystem::remove(Path("clip-cli.mkv"));
  }
}

// Three ways for a path that the option syntax cannot carry as it is.
TEST_F(FFmpegTest, AwkwardPathsGetThrough) {
  RSSTAB_NEEDS_FFMPEG();
  MakeClip("clip", 160, 120, 12);
  const std::string awkward = Path("a b:c|d,e;f'g[1].rsstab");
  std::filesystem::rename(Path("clip.rsstab"), awkward);
  Filter(Path("clip.mkv"), Plugin(Path("a%20b%3Ac%7Cd%2Ce%3Bf%27g%5B1%5D.rsstab")),
         Path("encoded.mkv"));
  EXPECT_GT(Psnr(Path("encoded.mkv"), Path("clip-cli.mkv")), kSameFrames_db);

  setenv("RSSTAB_ANALYSIS", awkward.c_str(), 1);
  Filter(Path("clip.mkv"), "frei0r=rsstabilize", Path("variable.mkv"));
  EXPECT_GT(Psnr(Path("variable.mkv"), Path("clip-cli.mkv")), kSameFrames_db);
  unsetenv("RSSTAB_ANALYSIS");

  std::filesystem::rename(awkward, Path("a b:c.rsstab"));
  Filter(Path("clip.mkv"), Plugin(Path("a b\\\\:c.rsstab")), Path("escaped.mkv"));
  EXPECT_GT(Psnr(Path("escaped.mkv"), Path("clip-cli.mkv")), kSameFrames_db);
}

TEST_F(FFmpegTest, AClipThatBeginsLaterIsRecognised) {
  RSSTAB_NEEDS_FFMPEG();
  MakeClip("clip", 320, 240);
  const std::string trimmed = "trim=start_frame=13,setpts=PTS-STARTPTS";
  Filter(Path("clip.mkv"), trimmed + "," + Plugin(Path("clip.rsstab")), Path("out.mkv"));
  Filter(Path("clip-cli.mkv"), trimmed, Path("expected.mkv"));
  EXPECT_GT(Psnr(Path("out.mkv"), Path("expected.mkv")), kSameFrames_db);
}

TEST_F(FFmpegTest, TwoFiltersInOneGraphStayApart) {
  RSSTAB_NEEDS_FFMPEG();
  MakeClip("a", 320, 240, 20);
  MakeClip("b", 208, 160, 20);
  FFmpeg({"-i", Path("a.mkv"), "-i", Path("b.mkv"), "-filter_complex",
          "[0:v]" + Plugin(Path("a.rsstab")) + ",format=yuv420p[a];[1:v]" +
              Plugin(Path("b.rsstab")) + ",format=yuv420p[b]",
          "-map", "[a]", "-c:v", "ffv1", Path("a-out.mkv"), "-map", "[b]", "-c:v", "ffv1",
          Path("b-out.mkv")});
  EXPECT_GT(Psnr(Path("a-out.mkv"), Path("a-cli.mkv")), kSameFrames_db);
  EXPECT_GT(Psnr(Path("b-out.mkv"), Path("b-cli.mkv")), kSameFrames_db);
}

// The recipe of docs/plugins.md: frames are neither lost nor late, and the sound is not touched.
TEST_F(FFmpegTest, LiveRecipeKeepsFramesAndTimes) {
  RSSTAB_NEEDS_FFMPEG();
  MakeClip("clip", 320, 240, 40);
  const std::string recipe = "tpad=stop=8:stop_mode=clone," + Plugin("|auto|0.1|0.8|0|0.08") +
                             ",trim=start_frame=8,setpts=PTS-STARTPTS";
  Filter(Path("clip.mkv"), recipe, Path("out.mkv"));
  const auto times = [&](const std::string& clip) {
    // "stream, dts, pts, duration, size, hash" of each frame.
    std::istringstream lines(FrameHashes(clip, "null"));
    std::vector<std::string> result;
    for (std::string line; std::getline(lines, line);) {
      if (!line.empty() && line.front() != '#') {
        result.push_back(line.substr(0, line.rfind(',')));
      }
    }
    return result;
  };
  EXPECT_EQ(times(Path("out.mkv")), times(Path("clip.mkv")));
  EXPECT_GT(Psnr(Path("out.mkv"), Path("clip-cli.mkv")),
            Psnr(Path("clip.mkv"), Path("clip-cli.mkv")));
  // Each frame in its place. Steady frames are all alike, so this is seen without smoothing.
  const std::string unsmoothed = "tpad=stop=8:stop_mode=clone," + Plugin("|off|0|0.8|0|0.08") +
                                 ",trim=start_frame=8,setpts=PTS-STARTPTS";
  Filter(Path("clip.mkv"), unsmoothed, Path("same.mkv"));
  Filter(Path("same.mkv"), "trim=start_frame=1,setpts=PTS-STARTPTS", Path("early.mkv"));
  EXPECT_GT(Psnr(Path("same.mkv"), Path("clip.mkv")),
            Psnr(Path("early.mkv"), Path("clip.mkv")) + 3.0);
}

}  // namespace
}  // namespace rsstab::frei0r::testing
