// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_synthetic.h"

#include <utility>

#include "evaluation/photo.h"
#include "igf/base/parallel_for.h"

namespace rsstab::cli {

using evaluation::EvaluationProgress;
using evaluation::MethodFactory;

Result<SyntheticReport> EvaluateSynthetic(const EvaluateOptions& options,
                                          const MethodFactory& factory, const Logger& logger,
                                          const EvaluationProgress& progress) {
  if (options.photos.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--photos: the protocol synthetic-val needs a folder of photographs.");
  }
  auto photos = evaluation::ListPhotos(options.photos);
  if (!photos) {
    return Propagate(photos.error());
  }
  if (options.limit > 0 && static_cast<std::int64_t>(photos->size()) > options.limit) {
    photos->resize(static_cast<std::size_t>(options.limit));
  }
  evaluation::SyntheticOptions run;
  run.seed = static_cast<std::uint64_t>(options.seed);
  run.jobs = ResolveThreadCount(options.jobs);
  run.linearity_photos = static_cast<int>(options.linearity_photos);
  if (!options.structured.empty()) {
    auto names = evaluation::ReadPhotoList(options.structured, options.structured_source);
    if (!names) {
      return Propagate(names.error());
    }
    run.structured = std::move(*names);
  }
  auto records = evaluation::RunSyntheticProtocol(*photos, run, factory, progress);
  if (!records) {
    return Propagate(records.error());
  }
  SyntheticReport report;
  report.header = MakeHeader(options, std::move(records->failures));
  WarnOfFailures(report.header, logger);
  report.photos = photos->size() - report.header.failures.size();
  report.groups = evaluation::SummariseSamples(records->samples, run.seed);
  report.skew = evaluation::SummariseSkew(records->skews, run.seed);
  report.samples = std::move(records->samples);
  return report;
}

}  // namespace rsstab::cli
