// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMAND_CONTEXT_H_
#define RSSTAB_CLI_COMMAND_CONTEXT_H_

#include <memory>

#include "cli/progress_reporter.h"
#include "cli/stage_times.h"
#include "igf/base/log.h"

namespace rsstab::cli {

// How a running command talks to its user.
struct CommandContext {
  Logger logger;
  std::shared_ptr<ProgressReporter> reporter;
  // What the passes spent their time on, for reports; written by the thread that runs them.
  std::shared_ptr<StageTimes> times = std::make_shared<StageTimes>();
};

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMAND_CONTEXT_H_
