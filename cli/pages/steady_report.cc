// SPDX-License-Identifier: Apache-2.0
#include "cli/pages/steady_report.h"

#include <utility>

#include "cli/pages/steady_page.h"

namespace rsstab::cli {
namespace {

// What was asked of the encoder, "--codec hevc --crf 22".
std::string EncodeCommand(const EncodeOptions& encode) {
  std::string command;
  for (const auto& option : EncodeOptionTable()) {
    const std::string value = option.get(encode);
    if (option.group == "Encoding" && value != option.get(EncodeOptions())) {
      command += (command.empty() ? "--" : " --") + option.name + " " + value;
    }
  }
  return command;
}

}  // namespace

Result<SteadyReportFile> OpenSteadyReport(const EncodeOptions& encode,
                                          const std::vector<std::string>& others) {
  if (encode.report.empty()) {
    return std::nullopt;
  }
  auto file = ReportFile::Open(encode.report, encode.overwrite, others);
  if (!file) {
    return Propagate(file.error());
  }
  return std::move(*file);
}

Status RenderWithReport(std::unique_ptr<media::VideoReader> clip, SteadyClip output,
                        const EncodeOptions& encode, const pipeline::StabilizeOptions& options,
                        const std::string& analysis_file, PassNumber number,
                        SteadyReportFile report, const CommandContext& context) {
  if (!report) {
    return RenderClip(std::move(clip), std::move(output), options, analysis_file, number, context);
  }
  auto page = SteadyPage::Create(analysis_file, clip->info(), output.path);
  if (!page) {
    return Propagate(page.error());
  }
  if (Status rendered =
          RenderClip(std::move(clip), std::move(output), options, analysis_file, number, context,
                     [&page](const media::VideoFrame& frame, const Frame& steady) {
                       return (*page)->Observe(frame, steady);
                     });
      !rendered) {
    return rendered;
  }
  const auto html = (*page)->Make(EncodeCommand(encode), context.times->stages());
  if (!html) {
    return Propagate(html.error(), encode.report);
  }
  return report->Write(*html);
}

}  // namespace rsstab::cli
