// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_SYNTHETIC_EXHIBITS_H_
#define RSSTAB_CLI_PAGES_SYNTHETIC_EXHIBITS_H_

#include <cstddef>
#include <vector>

#include "cli/commands/evaluate_synthetic.h"
#include "cli/pages/picture_panels.h"
#include "cli/report/html_page.h"
#include "evaluation/motion_method.h"

namespace rsstab::cli {

// The method whose pictures are shown: the one that comes closest over all moving classes.
[[nodiscard]] std::size_t ShownMethod(const SyntheticReport& report);

// Of the moving pictures one where that method gains most, an average one and one where it gains
// least; and the still picture that it moves most, if it moves any.
[[nodiscard]] std::vector<ChosenPicture> ChoosePictures(const SyntheticReport& report,
                                                        std::size_t method);

// Makes the chosen pictures once more, and shows what the methods make of them.
// Errors: those of the photographs and the methods.
[[nodiscard]] Status AddPictures(const SyntheticReport& report, const EvaluateOptions& options,
                                 const evaluation::MethodFactory& factory, report::HtmlPage& html);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_SYNTHETIC_EXHIBITS_H_
