// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_METHODS_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_METHODS_H_

#include "cli/commands/evaluate_options.h"
#include "evaluation/motion_method.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// The methods that the options ask for.
// Errors: kInvalidArgument for an unknown method, or too few calibration samples; those of loading
// the models, which are tried once here.
[[nodiscard]] Result<evaluation::MethodFactory> MakeMethodFactory(const EvaluateOptions& options);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_METHODS_H_
