// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_ROBUSTNESS_DAMAGE_H_
#define RSSTAB_TESTS_ROBUSTNESS_DAMAGE_H_

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tests/support/test_clip.h"
#include "tests/support/test_paths.h"

namespace rsstab::testing {

using Bytes = std::vector<std::uint8_t>;

[[nodiscard]] Bytes ReadBytes(const std::filesystem::path& path);
void WriteBytes(const std::filesystem::path& path, const Bytes& bytes);
void WriteText(const std::filesystem::path& path, const std::string& text);

// Number of video frames in a file; -1 when it cannot be read.
[[nodiscard]] int CountFrames(const std::filesystem::path& path);

// The rs-stabilize that was built with this test. Progress is off unless asked for.
[[nodiscard]] ProgramResult RunStabilizer(std::vector<std::string> arguments,
                                          ProgramSettings settings = {});

// A test with a folder of its own in which the program runs; remembers what lay there before.
class Damage : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path Path(const std::string& name) const { return folder_ / name; }

  // Runs the program in the folder.
  [[nodiscard]] ProgramResult Run(const std::vector<std::string>& arguments,
                                  ProgramSettings settings = {});

  // The run ended by itself with `exit_code`, said why in one sentence that holds `words`, and left
  // nothing new in the folder.
  void ExpectRefusal(const std::vector<std::string>& arguments, int exit_code,
                     const std::string& words, ProgramSettings settings = {});

  // The run succeeded, and `output` holds `frames` frames (not checked when negative).
  void ExpectSuccess(const std::vector<std::string>& arguments, const std::string& output,
                     int frames);

 private:
  TemporaryFolder folder_;
};

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_ROBUSTNESS_DAMAGE_H_
