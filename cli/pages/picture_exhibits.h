// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_PICTURE_EXHIBITS_H_
#define RSSTAB_CLI_PAGES_PICTURE_EXHIBITS_H_

#include <cstddef>
#include <vector>

#include "cli/commands/evaluate_pictures.h"
#include "cli/pages/picture_panels.h"
#include "cli/report/html_page.h"
#include "evaluation/labelled_picture.h"
#include "evaluation/motion_method.h"

namespace rsstab::cli {

// The method whose pictures are shown: of those that estimate (are told no motion), the one with
// the smallest error, else the highest PSNR; the first of all when there is none but "none".
[[nodiscard]] std::size_t ShownMethod(const PictureReport& report);

// Where that method gains most, an average picture, and where it gains least.
[[nodiscard]] std::vector<ChosenPicture> ChoosePictures(const PictureReport& report,
                                                        std::size_t method);

// Asks the methods about the chosen pictures once more and shows what they make of them: a slider,
// how each result lies on the truth, and the motion fields.
// Errors: those of the data set and the methods.
[[nodiscard]] Status AddPictures(const PictureReport& report, const evaluation::PictureSet& set,
                                 const EvaluateOptions& options,
                                 const evaluation::MethodFactory& factory, report::HtmlPage& html);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_PICTURE_EXHIBITS_H_
