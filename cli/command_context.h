// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMAND_CONTEXT_H_
#define RSSTAB_CLI_COMMAND_CONTEXT_H_

#include <memory>

#include "cli/progress_reporter.h"
#include "igf/base/log.h"

namespace rsstab::cli {

// How a running command talks to its user.
struct CommandContext {
  Logger logger;
  std::shared_ptr<ProgressReporter> reporter;
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMAND_CONTEXT_H_
