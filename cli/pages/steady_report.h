// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_PAGES_STEADY_REPORT_H_
#define RSSTAB_CLI_PAGES_STEADY_REPORT_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/encode_options.h"
#include "cli/pages/report_file.h"
#include "cli/passes.h"

namespace rsstab::cli {

// The file of --report of the commands that write a steady clip, or none.
using SteadyReportFile = std::optional<ReportFile>;

// Opens it where it was asked for; `others` as for ReportFile::Open. Errors: those of it.
[[nodiscard]] Result<SteadyReportFile> OpenSteadyReport(const EncodeOptions& encode,
                                                        const std::vector<std::string>& others);

// RenderClip, and then the report. When only the report fails, the clip stays.
[[nodiscard]] Status RenderWithReport(std::unique_ptr<media::VideoReader> clip, SteadyClip output,
                                      const EncodeOptions& encode,
                                      const pipeline::StabilizeOptions& options,
                                      const std::string& analysis_file, PassNumber number,
                                      SteadyReportFile report, const CommandContext& context);

}  // namespace rsstab::cli

#endif  // RSSTAB_CLI_PAGES_STEADY_REPORT_H_
