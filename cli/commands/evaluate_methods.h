// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_METHODS_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_METHODS_H_

#include <string>
#include <vector>

#include "cli/commands/evaluate_options.h"
#include "evaluation/motion_method.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// The names that --methods knows for pictures, separated by commas.
[[nodiscard]] std::string PictureMethodNames();
// The same, each with what it is, as the help has it.
[[nodiscard]] std::string PictureMethodHelp();

// The list of options.methods, or what data sets of pictures are given unless it was changed.
[[nodiscard]] std::string MethodsAskedFor(const EvaluateOptions& options);

// Whether all methods of options.methods are there, with settings that they have; loads nothing.
// Errors: kInvalidArgument, also for too few calibration samples.
[[nodiscard]] Status CheckPictureMethods(const EvaluateOptions& options);

// Methods that the options ask for and that are left out, since no weights are named for them.
[[nodiscard]] std::vector<std::string> MethodsWithoutWeights(const EvaluateOptions& options);

// The methods that the options ask for; none (the picture as it is) comes first in any case.
// regression and reference are left out where no weights are named for them.
// Errors: those of CheckPictureMethods and of loading the models, which are tried once here.
[[nodiscard]] Result<evaluation::MethodFactory> MakeMethodFactory(const EvaluateOptions& options);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_METHODS_H_
