// SPDX-License-Identifier: Apache-2.0
#include "tests/plugin/frei0r/host_programs.h"

#include <cstdlib>
#include <limits>

#include "tests/end_to_end/program.h"
#include "tests/support/test_clip.h"

namespace rsstab::frei0r::testing {

using rsstab::testing::NumberAfter;
using rsstab::testing::ProgramResult;
using rsstab::testing::ProgramSettings;
using rsstab::testing::RunOrFail;

namespace {

std::string RunHost(const std::string& program, const std::vector<std::string>& arguments) {
  ProgramSettings settings;
  settings.timeout_s = 300.0;
  const ProgramResult run = rsstab::testing::RunProgram(program, arguments, settings);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  return run.error;
}

}  // namespace

void HostPrograms::SetUp() {
  setenv("FREI0R_PATH", RSSTAB_FREI0R_FOLDER, 1);
  unsetenv("RSSTAB_ANALYSIS");
}

void HostPrograms::TearDown() {
  unsetenv("FREI0R_PATH");
  unsetenv("RSSTAB_ANALYSIS");
}

void HostPrograms::MakeClip(const std::string& name, int width, int height, int frames) {
  rsstab::testing::TestClip clip;
  clip.width = width;
  clip.height = height;
  clip.frames = frames;
  WriteTestClip(Path(name + ".mkv"), clip);
  RunOrFail({"analyze", Path(name + ".mkv"), "-o", Path(name + ".rsstab")});
  RunOrFail({"render", Path(name + ".mkv"), Path(name + ".rsstab"), "-o", Path(name + "-cli.mkv"),
             "--codec", "ffv1"});
}

std::string HostPrograms::FFmpeg(std::vector<std::string> arguments) {
  const std::vector<std::string> always = {"-hide_banner", "-nostdin", "-y"};
  arguments.insert(arguments.begin(), always.begin(), always.end());
  return RunHost(RSSTAB_FFMPEG, arguments);
}

std::string HostPrograms::Filter(const std::string& input, const std::string& filters,
                                 const std::string& output) {
  return FFmpeg({"-i", input, "-vf", filters + ",format=yuv420p", "-fps_mode", "passthrough",
                 "-c:v", "ffv1", output});
}

double HostPrograms::Psnr(const std::string& a, const std::string& b) {
  const std::string report = FFmpeg({"-i", a, "-i", b, "-lavfi",
                                     "settb=AVTB,setpts=N[a];[1:v]settb=AVTB,setpts=N[b];[a][b]"
                                     "psnr=shortest=1",
                                     "-f", "null", "-"});
  return report.find("average:inf") != std::string::npos ? std::numeric_limits<double>::infinity()
                                                         : NumberAfter(report, "average:");
}

std::string HostPrograms::FrameHashes(const std::string& input, const std::string& filters) {
  FFmpeg({"-i", input, "-vf", filters, "-fps_mode", "passthrough", "-f", "framemd5",
          Path("frames.md5")});
  return rsstab::testing::ReadText(Path("frames.md5"));
}

std::string HostPrograms::Melt(const std::vector<std::string>& arguments) {
  return RunHost(RSSTAB_MELT, arguments);
}

int CountOf(const std::string& text, const std::string& words) {
  int count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) {
    ++count;
  }
  return count;
}

}  // namespace rsstab::frei0r::testing
