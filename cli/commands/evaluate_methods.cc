// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_methods.h"

#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "evaluation/spread_coverage.h"
#include "rsdiff/model_path.h"
#include "rsdiff/single_image_motion.h"

namespace rsstab::cli {
namespace {

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

}  // namespace rsstab::cli
