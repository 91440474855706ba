// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_COMMANDS_EVALUATE_CLIPS_H_
#define RSSTAB_CLI_COMMANDS_EVALUATE_CLIPS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands/clip_set.h"
#include "cli/commands/compare.h"
#include "cli/commands/evaluate_options.h"
#include "cli/commands/evaluation_header.h"
#include "cli/pages/clip_showcase.h"
#include "cli/report/html_page.h"
#include "evaluation/for_each_item.h"
#include "evaluation/path_angle_score.h"
#include "evaluation/rs_field_score.h"
#include "igf/base/log.h"
#include "igf/base/result.h"

namespace rsstab::cli {

// What one method made of one clip.
struct ClipRun {
  std::string method;
  CompareReport::Clip clip;                     // the result; the clip itself for the method input
  std::optional<stabilizer::PairMetrics> pair;  // result against input; not for the method input
  // Own methods only.
  std::optional<evaluation::RsFieldScore> field;
  std::string rs_source;  // as the analysis file has it, and why
  std::string rs_reason;
  std::optional<double> readout_s;  // where a source is used that has one
  // Where the camera looked as the method found it, and how far that is from the truth: of a real
  // clip from what its gyro log says, where a method takes the rotation from there.
  evaluation::OrientationPath path;
  std::optional<evaluation::PathAngleScore> angle;
  // Wall time a frame, decoding and encoding included; empty for the method input.
  std::optional<double> analysis_ms;  // also empty for a tool of one pass
  std::optional<double> render_ms;
  std::optional<double> total_ms;
  std::optional<double> own_ms;  // less decoding (each pass) and encoding
};

struct ClipRecord {
  std::string name;
  ClipKind kind = ClipKind::kReal;
  std::optional<double> readout_s;  // the true one
  // Wall time a frame of decoding alone, and of decoding and encoding.
  std::optional<double> decode_ms;
  std::optional<double> recode_ms;
  std::vector<ClipRun> runs;             // in the order of the methods; failed ones are missing
  std::optional<ClipShowcase> showcase;  // for a page, of the first clips that are no twins
};

struct ClipsReport {
  EvaluationHeader header;
  std::vector<std::string> methods;
  std::vector<ClipRecord> clips;
};

// As for the other protocols (evaluate.h). The table and the JSON have means over the clips of each
// kind as well.
[[nodiscard]] std::string FormatText(const ClipsReport& report);
[[nodiscard]] std::string FormatJson(const ClipsReport& report);
[[nodiscard]] std::string FormatCsv(const ClipsReport& report);

// The same for a page: means over the clips of each kind, then each clip; the best figures are
// marked nowhere, since most of them are bought with others.
[[nodiscard]] std::vector<report::Table> FigureTables(const ClipsReport& report);

// Lets every method steady every clip of the folder options.clips, one after the other, and
// measures what comes out. Clips that cannot be used, methods that cannot run here and runs that
// fail are named in the header, with a warning, and left out. `progress` counts runs. Pictures are
// kept only where options.report asks for a page.
// Errors: those of FindClips and ParseClipMethods; that of the last thing left out when
// there is no run to report; kCancelled.
[[nodiscard]] Result<ClipsReport> EvaluateClips(
    const EvaluateOptions& options, const Logger& logger,
    const evaluation::EvaluationProgress& progress = {});

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_COMMANDS_EVALUATE_CLIPS_H_
