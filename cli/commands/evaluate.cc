// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include "evaluation/photo.h"
#include "evaluation/spread_coverage.h"
#include "igf/base/parallel_for.h"
#include "igf/base/whole_file.h"
#include "rsdiff/model_path.h"
#include "rsdiff/single_image_motion.h"

namespace rsstab::cli {
namespace {

using evaluation::EvaluationProgress;
using evaluation::MethodFactory;
using evaluation::MethodSet;
using evaluation::NoCorrection;
using evaluation::SingleImageMethod;
using rsdiff::SingleImageEstimator;

const char* const kNone = "none";
const char* const kRegression = "regression";
const char* const kSample = "sample";
const char* const kMean = "mean";

Result<std::set<std::string>> MethodsOf(const EvaluateOptions& options) {
  std::set<std::string> wanted;
  std::istringstream names(options.methods);
  for (std::string name; std::getline(names, name, ',');) {
    if (name != kNone && name != kRegression && name != kSample && name != kMean) {
      return Fail(ErrorCode::kInvalidArgument,
                  "--methods: there is no method '{}'; choose from none, regression, sample, mean.",
                  name);
    }
    wanted.insert(name);
  }
  if (options.regression_model.empty()) {
    wanted.erase(kRegression);
  }
  return wanted;
}

Result<std::shared_ptr<SingleImageEstimator>> LoadEstimator(const std::string& model,
                                                            const std::string& device) {
  const auto path = rsdiff::FindModel(model);
  if (!path) {
    return Propagate(path.error());
  }
  auto estimator = SingleImageEstimator::Load(*path, {device});
  if (!estimator) {
    return Propagate(estimator.error());
  }
  return std::make_shared<SingleImageEstimator>(std::move(*estimator));
}

rsdiff::SamplingOptions SamplingOf(const EvaluateOptions& options, int samples) {
  rsdiff::SamplingOptions sampling;
  sampling.samples = samples;
  sampling.steps = options.steps;
  sampling.guidance = options.guidance.value_or(sampling.guidance);
  sampling.eta = options.eta.value_or(sampling.eta);
  return sampling;
}

Result<MethodSet> MakeMethods(const EvaluateOptions& options, const std::set<std::string>& wanted) {
  MethodSet set;
  set.methods.push_back(std::make_unique<NoCorrection>());
  if (wanted.contains(kRegression)) {
    auto estimator = LoadEstimator(options.regression_model, options.device);
    if (!estimator) {
      return Propagate(estimator.error());
    }
    rsdiff::SamplingOptions once;
    once.samples = 1;
    set.methods.push_back(std::make_unique<SingleImageMethod>(kRegression, std::move(*estimator),
                                                              once, options.know_focal));
  }
  if (!wanted.contains(kSample) && !wanted.contains(kMean)) {
    return set;
  }
  const auto estimator = LoadEstimator(options.model, options.device);
  if (!estimator) {
    return Propagate(estimator.error());
  }
  const auto method = [&](const char* name, int samples) {
    return std::make_unique<SingleImageMethod>(name, *estimator, SamplingOf(options, samples),
                                               options.know_focal);
  };
  if (wanted.contains(kSample)) {
    set.methods.push_back(method(kSample, 1));
  }
  if (wanted.contains(kMean)) {
    set.methods.push_back(method(kMean, options.samples));
  }
  if (options.calibration_samples > 0) {
    set.sampler = method("calibration", options.calibration_samples);
  }
  set.skew = method(kMean, options.samples);
  return set;
}

std::vector<EvaluationSetting> SettingsOf(const EvaluateOptions& options) {
  std::vector<EvaluationSetting> settings;
  for (const auto& spec : EvaluateOptionTable()) {
    if (const std::string value = spec.get(options); !value.empty()) {
      settings.push_back({spec.name, value, value == spec.get(EvaluateOptions())});
    }
  }
  return settings;
}

void WarnOfFailures(const std::vector<std::pair<std::string, Error>>& failures,
                    const Logger& logger) {
  for (const auto& [name, error] : failures) {
    logger->warn("evaluate: {} is left out: {}", name, error.message);
  }
}

template <typename Item>
void Shorten(std::vector<Item>& items, std::int64_t limit) {
  if (limit > 0 && static_cast<std::int64_t>(items.size()) > limit) {
    items.resize(static_cast<std::size_t>(limit));
  }
}

// A long run should not end at a folder that was never there.
Status CheckOutputFolders(const EvaluateOptions& options) {
  for (const std::string& file : {options.csv, options.json}) {
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

Result<MethodFactory> MakeMethodFactory(const EvaluateOptions& options) {
  if (options.calibration_samples > 0 &&
      options.calibration_samples < evaluation::kLeastCoverageSamples) {
    return Fail(ErrorCode::kInvalidArgument,
                "--calibration-samples: the spread of {} samples says too little; give at least "
                "{}, or 0 to leave this out.",
                options.calibration_samples, evaluation::kLeastCoverageSamples);
  }
  const auto wanted = MethodsOf(options);
  if (!wanted) {
    return Propagate(wanted.error());
  }
  // Loading once here tells what is wrong before any photograph is decoded.
  if (auto tried = MakeMethods(options, *wanted); !tried) {
    return Propagate(tried.error());
  }
  return MethodFactory([options, wanted = *wanted] { return MakeMethods(options, wanted); });
}

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
  Shorten(*photos, options.limit);
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
  WarnOfFailures(records->failures, logger);
  SyntheticReport report;
  report.header = {SettingsOf(options), std::move(records->failures)};
  report.photos = photos->size() - report.header.failures.size();
  report.groups = evaluation::SummariseSamples(records->samples, run.seed);
  report.skew = evaluation::SummariseSkew(records->skews, run.seed);
  report.samples = std::move(records->samples);
  return report;
}

Result<PairReport> EvaluatePairs(const EvaluateOptions& options, const MethodFactory& factory,
                                 const Logger& logger, const EvaluationProgress& progress) {
  if (options.pairs.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--pairs: the protocol pairs needs a folder to look for them.");
  }
  auto pairs = evaluation::FindImagePairs(options.pairs);
  if (!pairs) {
    return Propagate(pairs.error());
  }
  Shorten(*pairs, options.limit);
  auto records = evaluation::RunImagePairs(
      *pairs, {static_cast<std::uint64_t>(options.seed), ResolveThreadCount(options.jobs)}, factory,
      progress);
  if (!records) {
    return Propagate(records.error());
  }
  WarnOfFailures(records->failures, logger);
  return PairReport{{SettingsOf(options), std::move(records->failures)}, std::move(records->pairs)};
}

Status RunEvaluate(const EvaluateOptions& options, const Logger& logger, std::ostream& out,
                   const EvaluationProgress& progress) {
  if (ResolveThreadCount(options.jobs) > 1) {
    // The photographs are what runs in parallel; OpenCV's own threads would only get in the way.
    cv::setNumThreads(1);
  }
  if (Status status = CheckOutputFolders(options); !status) {
    return status;
  }
  const auto factory = MakeMethodFactory(options);
  if (!factory) {
    return Propagate(factory.error());
  }
  if (options.protocol == EvaluationProtocol::kPairs) {
    const auto report = EvaluatePairs(options, *factory, logger, progress);
    return report ? WriteReport(*report, options, out) : Propagate(report.error());
  }
  const auto report = EvaluateSynthetic(options, *factory, logger, progress);
  return report ? WriteReport(*report, options, out) : Propagate(report.error());
}

}  // namespace rsstab::cli
