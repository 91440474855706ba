// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/analyze.h"

#include <utility>

#include "cli/output_names.h"
#include "cli/passes.h"

namespace rsstab::cli {

Status RunAnalyze(const Invocation& invocation, const CommandContext& context) {
  const std::string analysis_file = invocation.analysis_file.empty()
                                        ? DefaultAnalysisFile(invocation.input)
                                        : invocation.analysis_file;
  if (Status status = CheckOutput(invocation.input, analysis_file, invocation.encode.overwrite);
      !status) {
    return status;
  }
  auto clip = OpenClip(invocation.input, invocation.stabilize, context.logger);
  if (!clip) {
    return Propagate(clip.error());
  }
  const auto analysis =
      AnalyzeClip(std::move(*clip), invocation.stabilize, analysis_file, {1, 1}, context);
  if (!analysis) {
    return Propagate(analysis.error());
  }
  context.logger->info("{}: {} frames analysed, at least {:.1f} % of each side kept", analysis_file,
                       analysis->num_frames, 100.0 * analysis->smallest_kept_ratio);
  return {};
}

}  // namespace rsstab::cli
