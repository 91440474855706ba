// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate.h"

#include <filesystem>
#include <functional>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <system_error>

#include "cli/commands/evaluate_clips.h"
#include "cli/commands/evaluate_methods.h"
#include "cli/commands/evaluate_pictures.h"
#include "cli/commands/evaluate_synthetic.h"
#include "cli/pages/evaluation_page.h"
#include "cli/pages/report_file.h"
#include "cli/stage_times.h"
#include "igf/base/parallel_for.h"
#include "igf/base/whole_file.h"

namespace rsstab::cli {
namespace {

// A long run should not end at a folder that was never there.
Status CheckOutputFolders(const EvaluateOptions& options) {
  for (const std::string& file : {options.csv, options.json, options.state}) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    std::error_code error;
    if (!folder.empty() && !std::filesystem::is_directory(folder, error)) {
      return Fail(ErrorCode::kNotFound, "{}: there is no folder {} to write it to.", file,
                  folder.string());
    }
  }
  return {};
}

// Makes the page of a report, given how long its figures took.
template <typename Report>
using PageMaker =
    std::function<Result<std::string>(const Report& report, const std::vector<StageTime>& stages)>;

// Lets `evaluate` make the report, and writes it: table to `out`, the other forms to their files.
template <typename Report>
Status WriteReport(const EvaluateOptions& options, std::ostream& out,
                   const std::function<Result<Report>()>& evaluate,
                   const PageMaker<Report>& make_page) {
  std::optional<ReportFile> file;
  if (!options.report.empty()) {
    auto opened = ReportFile::Open(options.report, options.overwrite,
                                   {options.csv, options.json, options.state});
    if (!opened) {
      return Propagate(opened.error());
    }
    file.emplace(std::move(*opened));
  }
  StageTimes times;
  const Result<Report> made = times.Measure("Evaluate", evaluate);
  if (!made) {
    return Propagate(made.error());
  }
  const Report& report = *made;
  if (file) {
    const auto page = make_page(report, times.stages());
    if (!page) {
      return Propagate(page.error(), options.report);
    }
    if (Status written = file->Write(*page); !written) {
      return written;
    }
  }
  out << FormatText(report);
  if (!options.csv.empty()) {
    if (Status status = WriteWholeFile(options.csv, FormatCsv(report)); !status) {
      return status;
    }
  }
  if (!options.json.empty()) {
    return WriteWholeFile(options.json, FormatJson(report));
  }
  return {};
}

}  // namespace

Status RunEvaluate(const EvaluateOptions& options, const Logger& logger, std::ostream& out,
                   const evaluation::EvaluationProgress& progress) {
  if (Status status = CheckOutputFolders(options); !status) {
    return status;
  }
  if (options.protocol == EvaluationProtocol::kClips || !options.clips.empty()) {
    return WriteReport<ClipsReport>(
        options, out, [&] { return EvaluateClips(options, logger, progress); },
        [](const auto& report, const auto& stages) { return MakeEvaluationPage(report, stages); });
  }
  if (ResolveThreadCount(options.jobs) > 1) {
    // The photographs are what runs in parallel; OpenCV's own threads would only get in the way.
    cv::setNumThreads(1);
  }
  EvaluateOptions chosen = options;
  if (options.protocol != EvaluationProtocol::kSyntheticVal &&
      options.methods == EvaluateOptions().methods) {
    chosen.methods = kDatasetMethods;
  }
  const auto factory = MakeMethodFactory(chosen);
  if (!factory) {
    return Propagate(factory.error());
  }
  for (const std::string& method : MethodsWithoutWeights(chosen)) {
    logger->info("evaluate: {} is left out; --{}-model names its weights", method,
                 method.substr(0, method.find('@')));
  }
  if (options.protocol != EvaluationProtocol::kSyntheticVal) {
    return WriteReport<PictureReport>(
        options, out, [&] { return EvaluatePictures(chosen, *factory, logger, progress); },
        [&](const auto& report, const auto& stages) {
          return MakeEvaluationPage(report, chosen, *factory, stages);
        });
  }
  return WriteReport<SyntheticReport>(
      options, out, [&] { return EvaluateSynthetic(options, *factory, logger, progress); },
      [&](const auto& report, const auto& stages) {
        return MakeEvaluationPage(report, options, *factory, stages);
      });
}

}  // namespace rsstab::cli
