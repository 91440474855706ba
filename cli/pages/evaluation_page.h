// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_EVALUATION_PAGE_H_
#define RSSTAB_CLI_PAGES_EVALUATION_PAGE_H_

#include <string>
#include <vector>

#include "cli/commands/evaluate_clips.h"
#include "cli/commands/evaluate_pictures.h"
#include "cli/commands/evaluate_synthetic.h"
#include "cli/stage_times.h"
#include "evaluation/motion_method.h"

namespace rsstab::cli {

// The reports of `evaluate` as pages: tables, charts, and of pictures some of them with what each
// method made of it. Errors: those of making the pictures.
[[nodiscard]] Result<std::string> MakeEvaluationPage(const SyntheticReport& report,
                                                     const EvaluateOptions& options,
                                                     const evaluation::MethodFactory& factory,
                                                     const std::vector<StageTime>& stages);
[[nodiscard]] Result<std::string> MakeEvaluationPage(const ClipsReport& report,
                                                     const std::vector<StageTime>& stages);
[[nodiscard]] Result<std::string> MakeEvaluationPage(const PictureReport& report,
                                                     const EvaluateOptions& options,
                                                     const evaluation::MethodFactory& factory,
                                                     const std::vector<StageTime>& stages);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_EVALUATION_PAGE_H_
