// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CALIBRATE_OPTIONS_H_
#define RSSTAB_CLI_COMMANDS_CALIBRATE_OPTIONS_H_

#include <string>

#include "stabilizer/pipeline/option_table.h"

namespace rsstab::cli {

// What `rs-stabilize calibrate IN` writes, and how. Defaults are the member initialisers; what is
// known of the camera is told by the options of pipeline::StabilizeOptions.
struct CalibrateOptions {
  std::string output;      // camera JSON; empty: none
  std::string curves;      // SVG; empty: none
  bool overwrite = false;  // either may replace a file
  bool json = false;       // for programs instead of people
};

// All options but the clip, which is the command's positional argument.
[[nodiscard]] const pipeline::OptionTable<CalibrateOptions>& CalibrateOptionTable();

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CALIBRATE_OPTIONS_H_
