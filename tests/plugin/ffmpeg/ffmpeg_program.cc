// SPDX-License-Identifier: Apache-2.0
#include "tests/plugin/ffmpeg/ffmpeg_program.h"

#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>

namespace rsstab::testing {
namespace {

namespace fs = std::filesystem;

constexpr double kBuildTimeout_s = 1500.0;

// The smallest FFmpeg that the tests can work with.
const std::vector<std::string> kMinimal = {
    "--disable-everything",
    "--disable-autodetect",
    "--disable-network",
    "--disable-x86asm",  // no assembler needed; valgrind understands everything
    "--disable-stripping",
    "--disable-ffplay",
    "--enable-protocol=file,pipe",
    "--enable-demuxer=matroska,mov,rawvideo",
    "--enable-muxer=matroska,framecrc,null,rawvideo",
    "--enable-decoder=ffv1,mpeg4,rawvideo",
    "--enable-encoder=ffv1,rawvideo,wrapped_avframe",
    "--enable-parser=mpeg4video",
    "--enable-filter=rsanalyze,rsstabilize,lut,negate,format,scale,sendcmd,null,setsar,setparams,"
    "metadata,showinfo,trim",
};

// Result of the one build of this process.
std::optional<ProgramResult> build;  // NOLINT: set once by the first test suite

bool IsAskedFor() {
  const char* wish = std::getenv("RSSTAB_TEST_FFMPEG");
  return wish != nullptr && std::string(wish) == "1";
}

fs::path CacheFolder() {
  if (const char* folder = std::getenv("RSSTAB_FFMPEG_CACHE")) {
    return folder;
  }
  if (const char* folder = std::getenv("XDG_CACHE_HOME")) {
    return fs::path(folder) / "rs-stabilize";
  }
  const char* home = std::getenv("HOME");
  return fs::path(home != nullptr ? home : "/tmp") / ".cache" / "rs-stabilize";
}

// What an installed library would bring, for the one in the build tree.
void WritePackageFile(const fs::path& folder) {
  const std::string library = RSSTAB_LIBRARY_DIR;
  fs::create_directories(folder);
  std::ofstream(folder / "rsstab.pc")
      << "libdir=" << library
      << "\nName: rsstab\nDescription: library of this build tree\nVersion: " RSSTAB_PACKAGE_VERSION
      << "\nCflags: -I" << SourceFile("plugin/capi").string() << "\nLibs: -L" << library
      << " -lrsstab\n";
}

}  // namespace

ProgramResult BuildFfmpeg(const std::vector<std::string>& settings, const std::string& folder,
                          const std::vector<std::string>& options) {
  const fs::path cache = CacheFolder();
  WritePackageFile(cache / "pkgconfig");
  std::vector<std::string> arguments = {"PKG_CONFIG_PATH=" + (cache / "pkgconfig").string(), "bash",
                                        SourceFile("plugin/ffmpeg/build_ffmpeg.sh").string()};
  arguments.insert(arguments.end(), settings.begin(), settings.end());
  arguments.push_back((cache / folder).string());
  arguments.insert(arguments.end(), options.begin(), options.end());
  ProgramSettings run;
  run.timeout_s = kBuildTimeout_s;
  return RunProgram("/usr/bin/env", arguments, run);
}

void FfmpegTest::SetUpTestSuite() {
  if (IsAskedFor() && !build) {
    build = BuildFfmpeg({}, RSSTAB_FFMPEG_FOLDER, kMinimal);
  }
}

void FfmpegTest::SetUp() {
  if (!IsAskedFor()) {
    GTEST_SKIP() << "RSSTAB_TEST_FFMPEG=1 is not set: FFmpeg is not fetched and built";
  }
  ASSERT_EQ(build->exit_code, 0) << build->error;
}

const fs::path& FfmpegTest::program() {
  static const fs::path path = CacheFolder() / RSSTAB_FFMPEG_FOLDER / "ffmpeg";
  return path;
}

ProgramResult FfmpegTest::Ffmpeg(const std::vector<std::string>& arguments) const {
  std::vector<std::string> all = {"-hide_banner", "-nostdin", "-y", "-loglevel", "info"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  ProgramSettings settings;
  settings.folder = folder_.path();
  return RunProgram(program(), all, settings);
}

ProgramResult FfmpegTest::FfmpegOrFail(const std::vector<std::string>& arguments) const {
  ProgramResult run = Ffmpeg(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  return run;
}

std::vector<std::string> FfmpegTest::FrameList(const std::vector<std::string>& input,
                                               const std::string& filters) const {
  std::vector<std::string> arguments = input;
  for (const char* word : {"-vf", filters.c_str(), "-fps_mode", "passthrough", "-copyts",
                           "-enc_time_base", "-1", "-f", "framecrc", "-"}) {
    arguments.emplace_back(word);
  }
  std::istringstream text(FfmpegOrFail(arguments).output);
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    if (!line.empty() && line.front() != '#') {
      lines.push_back(line);
    }
  }
  return lines;
}

}  // namespace rsstab::testing
