// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_COMPARE_OPTIONS_H_
#define RSSTAB_CLI_COMMANDS_COMPARE_OPTIONS_H_

#include <string>

#include "stabilizer/pipeline/option_table.h"

namespace rsstab::cli {

// What `rs-stabilize compare IN OUT` is told. Defaults are the member initialisers.
struct CompareOptions {
  std::string input;   // the clip before
  std::string output;  // the clip after
  // What `simulate` wrote: its folder, or a file in it (truth.json, or the global-shutter clip
  // itself). Empty: no truth.
  std::string truth;
  std::string report;      // file for an HTML page; empty: none
  bool overwrite = false;  // the report may replace a file
  bool json = false;       // for programs instead of people
  int threads = 0;         // to decode and measure with; 0 = one per core
};

// All options but the two clips, which are the command's positional arguments.
[[nodiscard]] const pipeline::OptionTable<CompareOptions>& CompareOptionTable();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_COMPARE_OPTIONS_H_
