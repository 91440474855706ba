// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_CONSOLE_LOGGER_H_
#define RSSTAB_CLI_CONSOLE_LOGGER_H_

#include <memory>

#include "cli/progress_reporter.h"
#include "cli/run_options.h"
#include "igf/base/log.h"

namespace rsstab::cli {

// A logger whose lines go to where `reporter` writes, above its bar: "rs-stabilize: warning: ...".
[[nodiscard]] Logger MakeConsoleLogger(std::shared_ptr<ProgressReporter> reporter, LogLevel level);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_CONSOLE_LOGGER_H_
