// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_CLIP_CHARTS_H_
#define RSSTAB_CLI_PAGES_CLIP_CHARTS_H_

#include <vector>

#include "cli/pages/clip_page.h"
#include "cli/report/svg_chart.h"

namespace rsstab::cli {

// The camera path before and after: sideways, up and down, rotation, zoom.
[[nodiscard]] std::vector<report::LineChart> PathCharts(const CompareReport& report);

// What was corrected within the frames, and the share of a side that was kept.
[[nodiscard]] std::vector<report::LineChart> RsCharts(const std::vector<RsMoment>& moments);

// Camera residual over time, before and after; empty without a truth.
[[nodiscard]] std::vector<report::LineChart> TruthCharts(const CompareReport& report);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_CLIP_CHARTS_H_
