// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_EVALUATION_TABLES_H_
#define RSSTAB_CLI_PAGES_EVALUATION_TABLES_H_

#include <vector>

#include "cli/commands/evaluate_pictures.h"
#include "cli/commands/evaluate_synthetic.h"
#include "cli/report/html_page.h"
#include "cli/report/svg_chart.h"

namespace rsstab::cli {

// One table for each group of pictures: a line for each method, the best figures marked. Those of
// clips are in evaluate_clips.h.
[[nodiscard]] std::vector<report::Table> FigureTables(const SyntheticReport& report);
[[nodiscard]] std::vector<report::Table> FigureTables(const PictureReport& report);

// Which share of the pictures each method brings how close to the truth; empty without true fields.
[[nodiscard]] std::vector<report::LineChart> ErrorCharts(const SyntheticReport& report);
[[nodiscard]] std::vector<report::LineChart> ErrorCharts(const PictureReport& report);

// How the answers depend on a known skew; empty where it was not asked for.
[[nodiscard]] std::vector<report::LineChart> SkewCharts(const SyntheticReport& report);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_EVALUATION_TABLES_H_
