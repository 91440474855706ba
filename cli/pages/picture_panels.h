// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_PICTURE_PANELS_H_
#define RSSTAB_CLI_PAGES_PICTURE_PANELS_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/report/html_page.h"
#include "evaluation/motion_method.h"
#include "evaluation/picture_protocol.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// An item of a report that is shown, and why.
struct ChosenPicture {
  std::size_t record = 0;
  std::string reason;  // "gains most": what the method does there
};

// How well a method did over a whole report, for choosing whose pictures are shown.
struct MethodStanding {
  std::string method;
  double score = 0.0;  // more is better; NaN: not known
};

// The method whose pictures are shown: the best of those that estimate (are told no motion), else
// the best of those that are told; 0 when there is none but the first, which leaves pictures alone.
[[nodiscard]] std::size_t MethodToShow(std::span<const MethodStanding> methods);

// Where a method gains most, an average picture, and where it gains least; `gains` by record, those
// without a value left out.
[[nodiscard]] std::vector<ChosenPicture> ChooseByGain(std::span<const std::optional<double>> gains);

// What the page tells of one record: the picture with every method's answer, the figures of all
// methods (those without an answer are left out), and what the picture is called.
struct InspectedRecord {
  evaluation::PictureInspection inspection;
  std::vector<evaluation::MethodFigures> figures;
  std::string name;
};
using InspectRecord =
    std::function<Result<InspectedRecord>(std::size_t record, evaluation::MethodSet& methods)>;

// Adds a section with what the methods made of the chosen pictures: before and after, and against
// the truth, with sliders for `method`; how each result lies on the truth; the motion fields.
// Nothing when none is chosen. Errors: those of `factory`, `inspect` and making the pictures.
[[nodiscard]] Status ShowPictures(std::span<const ChosenPicture> chosen, std::size_t method,
                                  const evaluation::MethodFactory& factory,
                                  const InspectRecord& inspect, report::HtmlPage& html);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_PICTURE_PANELS_H_
