// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_EXIT_CODES_H_
#define RSSTAB_CLI_EXIT_CODES_H_

namespace rsstab::cli {

// What the shell gets to see.
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_EXIT_CODES_H_
