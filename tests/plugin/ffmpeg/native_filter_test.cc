// SPDX-License-Identifier: Apache-2.0
// What the filters rsanalyze and rsstabilize make of whole clips inside ffmpeg.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/media/media_test_support.h"
#include "tests/end_to_end/program.h"
#include "tests/plugin/ffmpeg/ffmpeg_program.h"
#include "tests/support/test_clip.h"

namespace rsstab::testing {
namespace {

using media::testing::LargestDifference;
using media::testing::ReadClip;
using media::testing::Remux;
using media::testing::RemuxRecipe;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kFrames = 24;

class NativeFilter : public FfmpegTest {
 protected:
  // A shaky clip, losslessly, in a pixel format of libav's.
  void MakeClip(const std::string& name, const std::string& format) {
    TestClip clip;
    clip.frames = kFrames;
    clip.layout = media::testing::PlanarYuv(10, 0, 0);
    clip.codec = "ffv1";
    WriteTestClip(Path("source.mkv"), clip);
    // At 25 frames a second Matroska's milliseconds are exact, and so is the rate that the program
    // reads out of them; at others the two differ by a tiny part, and the pictures by a level.
    FfmpegOrFail({"-r", "25", "-i", "source.mkv", "-pix_fmt", format, "-c:v", "ffv1", name});
  }

  void ExpectSameFrames(const std::string& a, const std::string& b) {
    const auto first = ReadClip(Path(a));
    const auto second = ReadClip(Path(b));
    ASSERT_TRUE(first && second);
    ASSERT_EQ(first->frames.size(), static_cast<std::size_t>(kFrames));
    ASSERT_EQ(second->frames.size(), first->frames.size());
    EXPECT_EQ(first->info.pixel_format, second->info.pixel_format);
    for (std::size_t i = 0; i < first->frames.size(); ++i) {
      EXPECT_EQ(LargestDifference(first->frames[i].frame, second->frames[i].frame), 0)
          << "frame " << i;
    }
  }
};

// The first columns of a frame list: stream, decoding time, presentation time, duration.
std::vector<std::string> TimesOf(const std::vector<std::string>& frames) {
  std::vector<std::string> times;
  for (const std::string& line : frames) {
    std::size_t end = 0;
    for (int column = 0; column < 4; ++column) {
      end = line.find(',', end + 1);
    }
    times.push_back(line.substr(0, end));
  }
  return times;
}

class NativeFilterFormats : public NativeFilter,
                            public ::testing::WithParamInterface<const char*> {};

TEST_P(NativeFilterFormats, TwoPassesEqualTheCommandLine) {
  MakeClip("clip.mkv", GetParam());
  RunOrFail({Path("clip.mkv"), "-o", Path("expected.mkv"), "--codec", "ffv1"});
  FfmpegOrFail({"-i", "clip.mkv", "-vf", "rsanalyze=clip.rsstab", "-f", "null", "-"});
  FfmpegOrFail({"-i", "clip.mkv", "-vf", "rsstabilize=clip.rsstab", "-c:v", "ffv1", "out.mkv"});
  ExpectSameFrames("expected.mkv", "out.mkv");
}

INSTANTIATE_TEST_SUITE_P(All, NativeFilterFormats,
                         ::testing::Values("yuv420p", "yuv422p", "yuv444p", "yuv420p10le",
                                           "yuv422p10le", "yuv444p10le", "gray", "gray10le"),
                         [](const auto& format) { return std::string(format.param); });

TEST_F(NativeFilter, InterleavedChromaEqualsPlanar) {
  MakeClip("clip.mkv", "yuv420p");
  RunOrFail({Path("clip.mkv"), "-o", Path("expected.mkv"), "--codec", "ffv1"});
  FfmpegOrFail({"-i", "clip.mkv", "-vf", "format=nv12,rsanalyze=clip.rsstab", "-f", "null", "-"});
  FfmpegOrFail({"-i", "clip.mkv", "-vf", "format=nv12,rsstabilize=clip.rsstab,format=yuv420p",
                "-c:v", "ffv1", "out.mkv"});
  ExpectSameFrames("expected.mkv", "out.mkv");
}

TEST_F(NativeFilter, AppliesAnAnalysisOfTheCommandLine) {
  MakeClip("clip.mkv", "yuv420p");
  RunOrFail({"analyze", Path("clip.mkv"), "-o", Path("clip.rsstab"), "--smoothness", "0.3"});
  RunOrFail({"render", Path("clip.mkv"), Path("clip.rsstab"), "-o", Path("expected.mkv"), "--codec",
             "ffv1"});
  FfmpegOrFail({"-i", "clip.mkv", "-vf", "rsstabilize=clip.rsstab", "-c:v", "ffv1", "out.mkv"});
  ExpectSameFrames("expected.mkv", "out.mkv");
}

TEST_F(NativeFilter, OptionsReachTheAnalysis) {
  MakeClip("clip.mkv", "yuv420p");
  RunOrFail({Path("clip.mkv"), "-o", Path("expected.mkv"), "--codec", "ffv1", "--crop", "0.7",
             "--smoothness", "0.4", "--zoom", "fixed", "--mesh", "4x4", "--interpolation",
             "lanczos"});
  FfmpegOrFail({"-i", "clip.mkv", "-vf",
                "rsanalyze=clip.rsstab:crop=0.7:smoothness=0.4:zoom=fixed:opts=mesh=4x4|seed=0",
                "-f", "null", "-"});
  FfmpegOrFail({"-i", "clip.mkv", "-vf", "rsstabilize=clip.rsstab:interpolation=lanczos", "-c:v",
                "ffv1", "out.mkv"});
  ExpectSameFrames("expected.mkv", "out.mkv");
}

TEST_F(NativeFilter, AnalysisHandsTheFramesThrough) {
  MakeClip("clip.mkv", "yuv420p");
  EXPECT_EQ(FrameList({"-i", "clip.mkv"}, "rsanalyze=clip.rsstab"),
            FrameList({"-i", "clip.mkv"}, "null"));
}

TEST_F(NativeFilter, KeepsUnevenTimesWhileLookingAhead) {
  TestClip clip;
  clip.frames = kFrames;
  WriteTestClip(Path("plain.mp4"), clip);
  RemuxRecipe recipe;
  for (int i = 0; i < kFrames; ++i) {
    recipe.video_times.push_back(9000 + 3000 * i + (i % 3) * 700 + i * i * 11);
  }
  Remux(Path("plain.mp4"), Path("uneven.mp4"), recipe);
  const std::vector<std::string> input = {"-i", "uneven.mp4"};
  const std::vector<std::string> expected = TimesOf(FrameList(input, "null"));
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(kFrames));
  // None, some, more than the clip has.
  for (const char* lookahead : {"0", "7", "100"}) {
    EXPECT_EQ(TimesOf(FrameList(input, std::string("rsstabilize=lookahead=") + lookahead)),
              expected)
        << lookahead;
  }
  FrameList(input, "rsanalyze=clip.rsstab");
  EXPECT_EQ(TimesOf(FrameList(input, "rsstabilize=clip.rsstab")), expected);
}

TEST_F(NativeFilter, LiveSteadiesWithoutAFile) {
  MakeClip("clip.mkv", "yuv420p");
  FfmpegOrFail({"-i", "clip.mkv", "-vf", "rsstabilize=lookahead=12", "-c:v", "ffv1", "out.mkv"});
  const ProgramResult report = RunOrFail({"compare", Path("clip.mkv"), Path("out.mkv"), "--json"});
  const double before =
      NumberAfter(report.output.substr(report.output.find("\"input\"")), "\"jitter_px\":");
  const double after =
      NumberAfter(report.output.substr(report.output.find("\"output\"")), "\"jitter_px\":");
  EXPECT_LT(after, 0.5 * before);
}

TEST_F(NativeFilter, PicturesDoNotDependOnThreads) {
  MakeClip("clip.mkv", "yuv420p");
  const auto frames = [this](const std::string& threads) {
    return FrameList({"-filter_threads", threads, "-i", "clip.mkv"}, "rsstabilize=lookahead=5");
  };
  EXPECT_EQ(frames("1"), frames("3"));
}

TEST_F(NativeFilter, KeepsShapeColourAndMetadata) {
  MakeClip("clip.mkv", "yuv420p");
  const std::string tags =
      "setsar=4/3,setparams=color_primaries=bt2020:color_trc=smpte2084:colorspace=bt2020nc:"
      "range=full,metadata=add:key=place:value=bridge";
  const std::string watch = ",showinfo,metadata=print:file=-";
  for (const char* filter :
       {"rsanalyze=clip.rsstab", "rsstabilize=clip.rsstab", "rsstabilize=lookahead=4"}) {
    const ProgramResult run =
        FfmpegOrFail({"-i", "clip.mkv", "-vf", tags + "," + filter + watch, "-f", "null", "-"});
    EXPECT_THAT(run.error, HasSubstr("sar:4/3")) << filter;
    EXPECT_THAT(run.error, HasSubstr("color_range:pc")) << filter;
    EXPECT_THAT(run.error, HasSubstr("color_primaries:bt2020")) << filter;
    EXPECT_THAT(run.error, HasSubstr("color_trc:smpte2084")) << filter;
    EXPECT_THAT(run.output, HasSubstr("place=bridge")) << filter;
  }
}

TEST_F(NativeFilter, CommandChangesTheSmoothnessFromThereOn) {
  MakeClip("clip.mkv", "yuv420p");
  const std::vector<std::string> plain =
      FrameList({"-i", "clip.mkv"}, "rsstabilize=lookahead=4:smoothness=1");
  const std::vector<std::string> changed =
      FrameList({"-i", "clip.mkv"},
                "sendcmd=c='0.4 rsstabilize smoothness 0',rsstabilize=lookahead=4:smoothness=1");
  ASSERT_EQ(changed.size(), plain.size());
  EXPECT_EQ(changed.front(), plain.front());
  EXPECT_NE(changed.back(), plain.back());
}

TEST_F(NativeFilter, CommandThatComesTooLateSaysSoAndChangesNothing) {
  MakeClip("clip.mkv", "yuv420p");
  FrameList({"-i", "clip.mkv"}, "rsanalyze=clip.rsstab");
  const ProgramResult run = FfmpegOrFail(
      {"-i", "clip.mkv", "-vf", "sendcmd=c='0.4 rsstabilize smoothness 0',rsstabilize=clip.rsstab",
       "-f", "null", "-"});
  EXPECT_THAT(run.error, HasSubstr("smoothness=0: "));
  EXPECT_EQ(FrameList({"-i", "clip.mkv"},
                      "sendcmd=c='0.4 rsstabilize smoothness 0',rsstabilize=clip.rsstab"),
            FrameList({"-i", "clip.mkv"}, "rsstabilize=clip.rsstab"));
}

}  // namespace
}  // namespace rsstab::testing
