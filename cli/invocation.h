// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_INVOCATION_H_
#define RSSTAB_CLI_INVOCATION_H_

#include <string>

#include "cli/commands/calibrate_options.h"
#include "cli/commands/compare_options.h"
#include "cli/commands/correct_options.h"
#include "cli/commands/evaluate_options.h"
#include "cli/commands/simulate_options.h"
#include "cli/encode_options.h"
#include "cli/run_options.h"
#include "stabilizer/pipeline/stabilize_options.h"

namespace rsstab::cli {

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

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_INVOCATION_H_
