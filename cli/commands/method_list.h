// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_METHOD_LIST_H_
#define RSSTAB_CLI_COMMANDS_METHOD_LIST_H_

#include <map>
#include <string>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::cli {

// One method of --methods as it was written: "diffusion@steps=1,samples=8".
struct MethodSpec {
  std::string text;                             // as reports call it
  std::string name;                             // "diffusion"
  std::map<std::string, std::string> settings;  // {"steps", "1"}, {"samples", "8"}
};

// "none,diffusion@steps=1,samples=8,gyro": methods between commas, each with settings after @ if
// it has any. A method named twice counts once.
// Errors: kInvalidArgument for a setting without a method or a value, or an empty name.
[[nodiscard]] Result<std::vector<MethodSpec>> ParseMethodList(const std::string& list);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_METHOD_LIST_H_
