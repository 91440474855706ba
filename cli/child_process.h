// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_CHILD_PROCESS_H_
#define RSSTAB_CLI_CHILD_PROCESS_H_

#include <filesystem>
#include <string>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::cli {

// Runs another program and waits for it: no shell, nothing on its standard input, in `folder`,
// looked up on PATH. What it prints, on either stream, comes back as text (the first 16 MiB).
// Errors: kNotFound when there is no such program; kIo when it cannot be started, fails (with the
// last line that it printed) or is ended by a signal; kCancelled when the user asked this program
// to stop, which ends the other one as well.
[[nodiscard]] Result<std::string> RunChild(const std::vector<std::string>& command,
                                           const std::filesystem::path& folder);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_CHILD_PROCESS_H_
