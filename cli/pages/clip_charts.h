// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_CLIP_CHARTS_H_
#define RSSTAB_CLI_PAGES_CLIP_CHARTS_H_

#include <vector>

#include "cli/pages/clip_page.h"
#include "cli/report/svg_chart.h"

namespace rsstab::cli {

// The camera path before and after: sideways, up and down, rotation, zoom.
[[nodiscard]] std::vector<report::LineChart> PathCharts(const CompareReport& report);

// What was corrected within the frames, and the share of a side that was kept. The motion within a
// frame grows with the readout time, which `analysis` has with its uncertainty: one standard
// deviation of it to either side is drawn as a band, where it is not known exactly.
[[nodiscard]] std::vector<report::LineChart> RsCharts(const std::vector<RsMoment>& moments,
                                                      const stabilizer::ClipAnalysis& analysis);

// Camera residual over time, before and after; empty without a truth.
[[nodiscard]] std::vector<report::LineChart> TruthCharts(const CompareReport& report);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_CLIP_CHARTS_H_
