// SPDX-License-Identifier: Apache-2.0
#include "tests/end_to_end/program.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

namespace rsstab::testing {

ProgramResult RunRsStabilize(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--progress", "none"});
  ProgramSettings settings;
  settings.timeout_s = 500.0;
  return RunProgram(RSSTAB_PROGRAM, arguments, settings);
}

ProgramResult RunOrFail(std::vector<std::string> arguments) {
  ProgramResult run = RunRsStabilize(std::move(arguments));
  EXPECT_EQ(run.exit_code, 0) << run.error;
  return run;
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

double NumberAfter(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  if (at == std::string::npos) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return std::strtod(text.c_str() + at + words.size(), nullptr);
}

}  // namespace rsstab::testing
