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

// What the titles mean, for people; docs/evaluation.md has the definitions.
inline constexpr const char* kClipFigureNote =
    "px at 640 px width; RS: root mean square of the rolling-shutter field applied; EPE of that "
    "field, in: of none; readout found, ms; angle (degrees) and rate (degrees/s): error of the "
    "camera's rotation and of its change from frame to frame, in: of no rotation; ms a frame with "
    "whatever else was running, own: less decoding and encoding";

// Those of a table of `runs` on clips of one kind.
[[nodiscard]] std::vector<const ClipFigure*> TableFigures(ClipKind kind,
                                                          const std::vector<const ClipRun*>& runs);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_CLIP_FIGURES_H_
