// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_RUN_OPTIONS_H_
#define RSSTAB_CLI_RUN_OPTIONS_H_

#include "stabilizer/pipeline/option_table.h"

namespace rsstab::cli {

enum class ProgressStyle { kAuto, kBar, kPlain, kJson, kNone };
enum class LogLevel { kDebug, kInfo, kWarn, kError, kOff };

// How the program talks while it runs. Defaults are the member initialisers.
struct RunOptions {
  ProgressStyle progress = ProgressStyle::kAuto;
  LogLevel log_level = LogLevel::kInfo;
};

// For commands that work through a clip; those that only print take the log level alone.
[[nodiscard]] const pipeline::OptionTable<RunOptions>& RunOptionTable();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_RUN_OPTIONS_H_
