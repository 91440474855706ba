// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_CLIP_FIGURES_H_
#define RSSTAB_CLI_COMMANDS_CLIP_FIGURES_H_

#include <functional>
#include <vector>

#include "cli/commands/evaluate_clips.h"

namespace rsstab::cli {

// A figure of a run, as all forms of the report know it.
struct ClipFigure {
  enum class Shown {
    kAlways,      // in every table
    kWhereKnown,  // in the tables of simulated clips and twins, and where a real clip has it
    kInFiles,     // in JSON and CSV only
  };
  const char* key;    // of JSON and CSV, units last
  const char* title;  // of the table
  int width;
  int digits;
  Shown shown;
  std::function<double(const ClipRun& run)> get;  // NaN: the run has none
};

// In the order of the columns.
[[nodiscard]] const std::vector<ClipFigure>& ClipFigures();

// Those of a table of `runs` on clips of one kind.
[[nodiscard]] std::vector<const ClipFigure*> TableFigures(ClipKind kind,
                                                          const std::vector<const ClipRun*>& runs);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CLIP_FIGURES_H_
