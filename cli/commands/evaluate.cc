// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate.h"

#include <filesystem>
#include <opencv2/core/utility.hpp>
#include <system_error>

#include "cli/commands/evaluate_clips.h"
#include "cli/commands/evaluate_methods.h"
#include "cli/commands/evaluate_pictures.h"
#include "cli/commands/evaluate_synthetic.h"
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

// Table to `out`, the other forms to their files.
template <typename Report>
Status WriteReport(const Report& report, const EvaluateOptions& options, std::ostream& out) {
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
    const auto report = EvaluateClips(options, logger, progress);
    return report ? WriteReport(*report, options, out) : Propagate(report.error());
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
  if (options.protocol != EvaluationProtocol::kSyntheticVal) {
    const auto report = EvaluatePictures(chosen, *factory, logger, progress);
    return report ? WriteReport(*report, options, out) : Propagate(report.error());
  }
  const auto report = EvaluateSynthetic(options, *factory, logger, progress);
  return report ? WriteReport(*report, options, out) : Propagate(report.error());
}

}  // namespace rsstab::cli
