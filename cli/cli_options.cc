// SPDX-License-Identifier: Apache-2.0
#include "cli/cli_options.h"

#include <algorithm>
#include <set>

#include "cli/command_apps.h"
#include "cli/commands/evaluate_check.h"
#include "cli/help_page.h"
#include "cli/manual_page.h"
#include "cli/shell_completion.h"

namespace rsstab::cli {
namespace {

EarlyExit UsageError(const std::string& program, const std::string& message) {
  return {kExitUsage, "", "rs-stabilize: " + message + "\nSee " + program + " --help.\n"};
}

// Long names of the options that were written.
std::set<std::string> GivenOptions(const CLI::App& app) {
  std::set<std::string> given;
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0) {
      given.insert(option->get_lnames().begin(), option->get_lnames().end());
    }
  }
  return given;
}

// What must go together, beyond the range of each option.
Status CheckTogether(const Invocation& invocation, const CLI::App& app) {
  if (Status status = pipeline::Validate(invocation.stabilize); !status) {
    return status;
  }
  switch (invocation.command) {
    case CommandId::kCorrect:
      return Validate(invocation.correct);
    case CommandId::kSimulate:
      return Validate(invocation.simulate, GivenOptions(app));
    case CommandId::kEvaluate:
      return Validate(invocation.evaluate, GivenOptions(app));
    default:
      return {};
  }
}

}  // namespace

std::variant<Invocation, EarlyExit> ParseCommandLine(const std::vector<std::string>& arguments) {
  // For the build, which installs what these print.
  if (arguments.size() == 1 && arguments[0] == "--print-manual") {
    return EarlyExit{kExitDone, ManualPage(), ""};
  }
  if (arguments.size() == 1 && arguments[0] == "--print-bash-completion") {
    return EarlyExit{kExitDone, BashCompletion(), ""};
  }

  CommandId id = CommandId::kStabilize;
  std::vector<std::string> rest = arguments;
  for (const CommandText& text : CommandTexts()) {
    if (!rest.empty() && !text.name.empty() && rest.front() == text.name) {
      id = text.id;
      rest.erase(rest.begin());
      break;
    }
  }

  Invocation invocation;
  const auto app = MakeCommandApp(id, invocation);
  std::reverse(rest.begin(), rest.end());  // CLI11 takes them from the back
  try {
    app->parse(rest);
  } catch (const CLI::CallForHelp&) {
    return EarlyExit{kExitDone, HelpPage(id), ""};
  } catch (const CLI::CallForVersion& version) {
    return EarlyExit{kExitDone, std::string(version.what()) + "\n", ""};
  } catch (const CLI::ExtrasError&) {
    return UsageError(app->get_name(), "what is '" + app->remaining().back() + "'? " +
                                           (app->remaining().back().starts_with("-")
                                                ? "There is no such option"
                                                : "It is one argument too many"));
  } catch (const CLI::ParseError& error) {
    return UsageError(app->get_name(), error.what());
  }
  if (const Status status = CheckTogether(invocation, *app); !status) {
    return UsageError(app->get_name(), status.error().message);
  }
  return invocation;
}

}  // namespace rsstab::cli
