// SPDX-License-Identifier: Apache-2.0
#include "tests/robustness/damage.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "cli/media/video_reader.h"

namespace rsstab::testing {
namespace {

std::set<std::string> Listing(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    names.insert(entry.path().string());
  }
  return names;
}

void ExpectNoCrash(const ProgramResult& run) {
  EXPECT_FALSE(run.timed_out) << run.error;
  EXPECT_EQ(run.signal, 0) << run.error;
  for (const char* report : {"AddressSanitizer", "LeakSanitizer", "runtime error:", "terminate"}) {
    EXPECT_EQ(run.error.find(report), std::string::npos) << run.error;
  }
}

}  // namespace

Bytes ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void WriteBytes(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

int CountFrames(const std::filesystem::path& path) {
  auto reader = media::VideoReader::Open(path.string(), {1, nullptr});
  if (!reader) {
    return -1;
  }
  int frames = 0;
  while (true) {
    const auto frame = (*reader)->Read();
    if (!frame) {
      return -1;
    }
    if (!*frame) {
      return frames;
    }
    ++frames;
  }
}

ProgramResult RunStabilizer(std::vector<std::string> arguments, ProgramSettings settings) {
  if (std::find(arguments.begin(), arguments.end(), "--progress") == arguments.end()) {
    arguments.insert(arguments.end(), {"--progress", "none"});
  }
  return RunProgram(RSSTAB_PROGRAM, arguments, settings);
}

ProgramResult Damage::Run(const std::vector<std::string>& arguments, ProgramSettings settings) {
  settings.folder = folder_.path();
  ProgramResult run = RunStabilizer(arguments, settings);
  ExpectNoCrash(run);
  return run;
}

void Damage::ExpectRefusal(const std::vector<std::string>& arguments, int exit_code,
                           const std::string& words, ProgramSettings settings) {
  const std::set<std::string> before = Listing(folder_.path());
  const ProgramResult run = Run(arguments, settings);
  EXPECT_EQ(run.exit_code, exit_code) << run.error;
  EXPECT_EQ(Listing(folder_.path()), before) << "left something behind";
  // Warnings may come first; what ended the run is the last sentence, and there is one only.
  std::istringstream lines(run.error);
  int sentences = 0;
  std::string reason;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("rs-stabilize: error: ")) {
      reason = line;
      ++sentences;
    }
  }
  EXPECT_EQ(sentences, 1) << run.error;
  EXPECT_THAT(reason, ::testing::HasSubstr(words));
}

void Damage::ExpectSuccess(const std::vector<std::string>& arguments, const std::string& output,
                           int frames) {
  const ProgramResult run = Run(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  const int written = CountFrames(Path(output));
  if (frames >= 0) {
    EXPECT_EQ(written, frames) << run.error;
  } else {
    EXPECT_GT(written, 0) << run.error;
  }
}

}  // namespace rsstab::testing
