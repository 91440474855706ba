// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CORRECT_PLAN_H_
#define RSSTAB_CLI_COMMANDS_CORRECT_PLAN_H_

#include <optional>
#include <string>
#include <vector>

#include "cli/commands/correct_options.h"
#include "cli/images/field_files.h"
#include "cli/images/image_list.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// One picture, and what is written for it.
struct CorrectionJob {
  std::string input;
  std::string output;  // empty: only the field is wanted
  std::optional<images::FieldFiles> field;
};

struct CorrectionPlan {
  std::vector<CorrectionJob> jobs;
  std::vector<Error> problems;       // one for each picture or argument that cannot be done
  std::vector<std::string> folders;  // to be made where they are missing
};

// Decides what goes where. No output is an input, two outputs never share a name, and what exists
// is replaced only with `overwrite`: a picture for which that cannot be had is a problem.
// Errors: kInvalidArgument when several pictures are to go into one file.
[[nodiscard]] Result<CorrectionPlan> PlanCorrections(const CorrectOptions& options,
                                                     images::ImageList list);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CORRECT_PLAN_H_
