// SPDX-License-Identifier: Apache-2.0
#include "cli/run_options.h"

namespace rsstab::cli {
namespace {

pipeline::OptionTable<RunOptions> BuildTable() {
  pipeline::OptionTableBuilder<RunOptions> table;
  table.Group("Running");
  table.Add(
      pipeline::ChoiceOption<RunOptions, ProgressStyle>("progress", &RunOptions::progress,
                                                        {{"auto", ProgressStyle::kAuto},
                                                         {"bar", ProgressStyle::kBar},
                                                         {"plain", ProgressStyle::kPlain},
                                                         {"json", ProgressStyle::kJson},
                                                         {"none", ProgressStyle::kNone}}),
      "How progress is shown on standard error: a bar, plain lines, one JSON object a line, or "
      "nothing; auto shows a bar on a terminal and plain lines elsewhere.");
  table.Add(pipeline::ChoiceOption<RunOptions, LogLevel>("log-level", &RunOptions::log_level,
                                                         {{"debug", LogLevel::kDebug},
                                                          {"info", LogLevel::kInfo},
                                                          {"warn", LogLevel::kWarn},
                                                          {"error", LogLevel::kError},
                                                          {"off", LogLevel::kOff}}),
            "Least important kind of message to print on standard error.");
  return table.Take();
}

}  // namespace

const pipeline::OptionTable<RunOptions>& RunOptionTable() {
  static const pipeline::OptionTable<RunOptions> table = BuildTable();
  return table;
}

}  // namespace rsstab::cli
