// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/render.h"

#include <utility>

#include "cli/output_names.h"
#include "cli/pages/steady_report.h"
#include "cli/passes.h"
#include "stabilizer/analysis_file.h"

namespace rsstab::cli {

Status RunRender(const Invocation& invocation, const CommandContext& context) {
  const std::string analysis_file = invocation.analysis_file.empty()
                                        ? DefaultAnalysisFile(invocation.input)
                                        : invocation.analysis_file;
  // Looked at first: without a good one there is no reason to begin an output.
  if (const auto analysis = stabilizer::AnalysisReader::Open(analysis_file); !analysis) {
    return Propagate(analysis.error());
  }
  auto clip = OpenClip(invocation.input, invocation.stabilize, context.logger);
  if (!clip) {
    return Propagate(clip.error());
  }
  auto output = OpenOutput(invocation.encode, invocation.stabilize, **clip, context.logger);
  if (!output) {
    return Propagate(output.error());
  }
  auto report =
      OpenSteadyReport(invocation.encode, {invocation.input, output->path, analysis_file});
  if (!report) {
    return Propagate(report.error());
  }
  return RenderWithReport(std::move(*clip), std::move(*output), invocation.encode,
                          invocation.stabilize, analysis_file, {1, 1}, std::move(*report), context);
}

}  // namespace rsstab::cli
