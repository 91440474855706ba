// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/stabilize.h"

#include <utility>

#include "cli/output_names.h"
#include "cli/pages/steady_report.h"
#include "cli/passes.h"

namespace rsstab::cli {

Status RunStabilize(const Invocation& invocation, const CommandContext& context) {
  const pipeline::StabilizeOptions& options = invocation.stabilize;
  const auto scratch = ScratchFolder::Create();
  if (!scratch) {
    return Propagate(scratch.error());
  }
  const std::string analysis_file = scratch->File("analysis");

  auto clip = OpenClip(invocation.input, options, context.logger);
  if (!clip) {
    return Propagate(clip.error());
  }
  // The output is opened before the long first pass, so that a bad name, codec or full disk shows
  // at once and not at half time.
  auto second_look = OpenClip(invocation.input, options, SilentLogger());
  if (!second_look) {
    return Propagate(second_look.error());
  }
  auto output = OpenOutput(invocation.encode, options, **second_look, context.logger);
  if (!output) {
    return Propagate(output.error());
  }

  auto report = OpenSteadyReport(invocation.encode, {invocation.input, output->path});
  if (!report) {
    return Propagate(report.error());
  }

  const auto analysis = AnalyzeClip(std::move(*clip), options, analysis_file, {1, 2}, context);
  if (!analysis) {
    return Propagate(analysis.error());
  }
  return RenderWithReport(std::move(*second_look), std::move(*output), invocation.encode, options,
                          analysis_file, {2, 2}, std::move(*report), context);
}

}  // namespace rsstab::cli
