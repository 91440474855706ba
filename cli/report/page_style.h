// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_REPORT_PAGE_STYLE_H_
#define RSSTAB_CLI_REPORT_PAGE_STYLE_H_

#include <string_view>

namespace rsstab::report {

// CSS of a page, without the colours and charts of svg_chart.h.
[[nodiscard]] std::string_view PageStyle();

// The page's one script: sliders follow pointer and keys. Without it they stand still.
[[nodiscard]] std::string_view PageScript();

}  // namespace rsstab::report

#endif  // RSSTAB_CLI_REPORT_PAGE_STYLE_H_
