// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMAND_APPS_H_
#define RSSTAB_CLI_COMMAND_APPS_H_

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/invocation.h"

namespace rsstab::cli {

// One command as help, manual and shell completion see it, beside its options.
struct CommandText {
  CommandId id;
  std::string name;     // empty: the main job, without a command word
  std::string usage;    // what follows the command's name: "IN [-o OUT]"
  std::string summary;  // half a line
  std::string description;
  std::vector<std::pair<std::string, std::string>> examples;  // command line, what it does
};

// All commands, the main job first.
[[nodiscard]] const std::vector<CommandText>& CommandTexts();
[[nodiscard]] const CommandText& TextOf(CommandId id);

// A parser that fills `invocation` (which must outlive it) with that command's arguments. Parsing
// throws CLI::ParseError.
[[nodiscard]] std::unique_ptr<CLI::App> MakeCommandApp(CommandId id, Invocation& invocation);

// What an option's description says, in its parts: joined once here for help and manual.
[[nodiscard]] std::string OptionFlags(const CLI::Option& option);  // "-o, --output FILE"

// The options of `app` that a user is told about, by heading, in the order of their definition;
// positional arguments come under the empty heading.
struct OptionGroup {
  std::string heading;
  std::vector<const CLI::Option*> options;
};
[[nodiscard]] std::vector<OptionGroup> VisibleOptions(const CLI::App& app);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMAND_APPS_H_
