// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_END_TO_END_PROGRAM_H_
#define RSSTAB_TESTS_END_TO_END_PROGRAM_H_

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace rsstab::testing {

// Runs the rs-stabilize that was built with this test, without progress.
ProgramResult RunRsStabilize(std::vector<std::string> arguments);
// The same; a failure of it is a failure of the test.
ProgramResult RunOrFail(std::vector<std::string> arguments);

[[nodiscard]] std::string ReadText(const std::filesystem::path& path);

// The number that follows `words` in `text`; NaN when there is none.
[[nodiscard]] double NumberAfter(const std::string& text, const std::string& words);

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_END_TO_END_PROGRAM_H_
