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

// Methods that the options ask for and that are left out, since no weights are named for them.
[[nodiscard]] std::vector<std::string> MethodsWithoutWeights(const EvaluateOptions& options);

// The methods that the options ask for; none (the picture as it is) comes first in any case.
// regression and reference are left out where no weights are named for them.
// Errors: kInvalidArgument for an unknown method, or too few calibration samples; those of loading
// the models, which are tried once here.
[[nodiscard]] Result<evaluation::MethodFactory> MakeMethodFactory(const EvaluateOptions& options);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_METHODS_H_
