// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_SUPPORT_RUN_PROGRAM_H_
#define RSSTAB_TESTS_SUPPORT_RUN_PROGRAM_H_

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rsstab::testing {

struct ProgramSettings {
  std::filesystem::path folder = ".";  // where it runs
  double timeout_s = 120.0;            // then it is killed, and timed_out is set
  // As if the disk were full: no file may grow beyond this (RLIMIT_FSIZE).
  std::optional<std::uint64_t> max_file_bytes;
  // Sends `signal` once this text has appeared on standard error.
  std::string signal_after;
  int signal = SIGINT;
  bool close_output = false;  // nobody reads standard output
};

struct ProgramResult {
  int exit_code = -1;  // -1 when a signal ended it
  int signal = 0;
  bool timed_out = false;
  std::string output;  // standard output
  std::string error;   // standard error
};

// Runs `program` with `arguments`, standard input empty, and waits for it. One at a time.
[[nodiscard]] ProgramResult RunProgram(const std::string& program,
                                       const std::vector<std::string>& arguments,
                                       const ProgramSettings& settings = {});

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_SUPPORT_RUN_PROGRAM_H_
