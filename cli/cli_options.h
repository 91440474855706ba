// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_CLI_OPTIONS_H_
#define RSSTAB_CLI_CLI_OPTIONS_H_

#include <string>
#include <variant>
#include <vector>

#include "cli/commands/calibrate_options.h"
#include "cli/commands/compare_options.h"
#include "cli/commands/correct_options.h"
#include "cli/commands/evaluate_options.h"
#include "cli/commands/simulate_options.h"
#include "cli/encode_options.h"
#include "cli/run_options.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::cli {

// What the shell gets to see.
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

enum class CommandId {
  kStabilize,
  kAnalyze,
  kCalibrate,
  kRender,
  kCorrect,
  kInfo,
  kCompare,
  kSimulate,
  kEvaluate
};

// A command line, understood: which command, and everything it was told. Fields that a command does
// not take keep their defaults.
struct Invocation {
  CommandId command = CommandId::kStabilize;
  std::string input;          // the clip
  std::string analysis_file;  // analyze writes it, render reads it; empty: beside the clip
  bool json = false;          // info: for programs instead of people
  pipeline::StabilizeOptions stabilize;
  EncodeOptions encode;
  CalibrateOptions calibrate;
  CorrectOptions correct;
  CompareOptions compare;
  SimulateOptions simulate;
  EvaluateOptions evaluate;
  RunOptions run;
};

// A command line that asks for text (help, version) or cannot be understood.
struct EarlyExit {
  int exit_code = kExitDone;
  std::string output;  // for standard output
  std::string error;   // for standard error: one sentence and where to find help
};

// `arguments` without the program's name. A first argument that is a command's name is that
// command; a clip of such a name is reached as ./analyze. Values are checked; files are not looked
// at.
[[nodiscard]] std::variant<Invocation, EarlyExit> ParseCommandLine(
    const std::vector<std::string>& arguments);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_CLI_OPTIONS_H_
