// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string>
#include <variant>
#include <vector>

#include "cli/cancellation.h"
#include "cli/cli_options.h"
#include "cli/run_command.h"

int main(int argc, char** argv) {
  using namespace rsstab::cli;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto parsed = ParseCommandLine(arguments);
  if (const auto* exit = std::get_if<EarlyExit>(&parsed)) {
    std::fputs(exit->error.c_str(), stderr);
    if (std::fputs(exit->output.c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
      std::fputs("rs-stabilize: error: standard output cannot be written\n", stderr);
      return kExitFailed;
    }
    return exit->exit_code;
  }
  InstallSignalHandlers();
  return RunCommand(std::get<Invocation>(parsed));
}
