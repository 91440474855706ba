// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_methods.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/commands/method_list.h"
#include "evaluation/baselines/homography_mixture.h"
#include "evaluation/baselines/rotation_spline.h"
#include "evaluation/baselines/straight_lines.h"
#include "evaluation/gyro_method.h"
#include "evaluation/spread_coverage.h"
#include "rsdiff/model_path.h"
#include "rsdiff/single_image_motion.h"

namespace rsstab::cli {
namespace {

using evaluation::GyroMethod;
using evaluation::HomographyMixtureMethod;
using evaluation::MethodFactory;
using evaluation::MethodSet;
using evaluation::NoCorrection;
using evaluation::RotationSplineMethod;
using evaluation::SingleImageMethod;
using evaluation::StraightLinesMethod;
using rsdiff::SingleImageEstimator;

const char* const kNone = "none";
const char* const kGyro = "gyro";
const char* const kGyroOneStep = "gyro-onestep";
const char* const kLines = "lines";
const char* const kHomographyMixture = "homography-mixture";
const char* const kRotationSpline = "rotation-spline";
const char* const kRegression = "regression";
const char* const kSample = "sample";
const char* const kMean = "mean";
const char* const kDiffusion = "diffusion";
const char* const kReference = "reference";

bool IsNetwork(const std::string& name) {
  return name == kRegression || name == kSample || name == kMean || name == kDiffusion ||
         name == kReference;
}

// What only the user can have weights of, and named none.
bool LacksWeights(const EvaluateOptions& options, const MethodSpec& method) {
  return (method.name == kRegression && options.regression_model.empty()) ||
         (method.name == kReference && options.reference_model.empty());
}

// Networks of one thread, each loaded once.
class Estimators {
 public:
  explicit Estimators(std::string device) : device_(std::move(device)) {}

  Result<std::shared_ptr<SingleImageEstimator>> Get(const std::string& model) {
    if (const auto known = loaded_.find(model); known != loaded_.end()) {
      return known->second;
    }
    const auto path = rsdiff::FindModel(model);
    if (!path) {
      return Propagate(path.error());
    }
    auto estimator = SingleImageEstimator::Load(*path, {device_});
    if (!estimator) {
      return Propagate(estimator.error());
    }
    return loaded_[model] = std::make_shared<SingleImageEstimator>(std::move(*estimator));
  }

 private:
  std::string device_;
  std::map<std::string, std::shared_ptr<SingleImageEstimator>> loaded_;
};

// The options of `evaluate` as one method's settings change them.
Result<EvaluateOptions> WithSettings(const EvaluateOptions& options, const MethodSpec& method) {
  EvaluateOptions changed = options;
  for (const auto& [name, value] : method.settings) {
    const bool is_known = name == "steps" || name == "samples" || name == "guidance" ||
                          name == "eta" || name == "model";
    if (!IsNetwork(method.name) || !is_known) {
      return Fail(ErrorCode::kInvalidArgument, "--methods: '{}' has no setting '{}'.", method.name,
                  name);
    }
    for (const auto& spec : EvaluateOptionTable()) {
      if (spec.name == name) {
        if (Status status = spec.set(changed, value); !status) {
          return Propagate(status.error(), "--methods: " + method.text);
        }
      }
    }
  }
  return changed;
}

std::string ModelOf(const EvaluateOptions& options, const MethodSpec& method) {
  if (method.name == kRegression) {
    return options.regression_model;
  }
  return method.name == kReference ? options.reference_model : options.model;
}

Result<std::unique_ptr<evaluation::MotionMethod>> MakeNetwork(const EvaluateOptions& options,
                                                              const MethodSpec& method,
                                                              Estimators& estimators) {
  const auto changed = WithSettings(options, method);
  if (!changed) {
    return Propagate(changed.error());
  }
  auto estimator = estimators.Get(ModelOf(*changed, method));
  if (!estimator) {
    return Propagate(estimator.error());
  }
  rsdiff::SamplingOptions sampling;
  const bool draws_one = method.name == kRegression || method.name == kSample;
  sampling.samples = draws_one ? 1 : changed->samples;
  if (method.name != kRegression) {
    sampling.steps = changed->steps;
    sampling.guidance = changed->guidance.value_or(sampling.guidance);
    sampling.eta = changed->eta.value_or(sampling.eta);
  }
  return std::make_unique<SingleImageMethod>(method.text, std::move(*estimator), sampling,
                                             changed->know_focal);
}

Result<std::unique_ptr<evaluation::MotionMethod>> MakeMethod(const EvaluateOptions& options,
                                                             const MethodSpec& method,
                                                             Estimators& estimators) {
  if (IsNetwork(method.name)) {
    return MakeNetwork(options, method, estimators);
  }
  if (method.name == kGyroOneStep) {
    const auto bands = method.settings.find("bands");
    const auto number = bands == method.settings.end()
                            ? std::optional<std::int64_t>(evaluation::kUsualBands)
                            : pipeline::ParseInteger(bands->second);
    if (method.settings.size() > (bands == method.settings.end() ? 0U : 1U) || !number ||
        *number < 1 || *number > 65535) {
      return Fail(ErrorCode::kInvalidArgument,
                  "--methods: {}: its one setting is bands, a whole number from 1.", method.text);
    }
    return std::make_unique<GyroMethod>(method.text, static_cast<int>(*number));
  }
  if (const auto checked = WithSettings(options, method); !checked) {
    return Propagate(checked.error());
  }
  if (method.name == kGyro) {
    return std::make_unique<GyroMethod>(method.text, 0);
  }
  if (method.name == kLines) {
    return std::make_unique<StraightLinesMethod>(options.know_focal);
  }
  if (method.name == kHomographyMixture) {
    return std::make_unique<HomographyMixtureMethod>();
  }
  if (method.name == kRotationSpline) {
    return std::make_unique<RotationSplineMethod>();
  }
  return Fail(ErrorCode::kInvalidArgument, "--methods: there is no method '{}'; choose from {}.",
              method.name, PictureMethodNames());
}

Result<MethodSet> MakeMethods(const EvaluateOptions& options,
                              const std::vector<MethodSpec>& wanted) {
  MethodSet set;
  set.methods.push_back(std::make_unique<NoCorrection>());
  Estimators estimators(options.device);
  bool draws = false;
  for (const MethodSpec& spec : wanted) {
    auto method = MakeMethod(options, spec, estimators);
    if (!method) {
      return Propagate(method.error());
    }
    set.methods.push_back(std::move(*method));
    draws = draws || spec.name == kSample || spec.name == kMean || spec.name == kDiffusion;
  }
  if (!draws || options.protocol != EvaluationProtocol::kSyntheticVal) {
    return set;
  }
  const auto estimator = estimators.Get(options.model);
  if (!estimator) {
    return Propagate(estimator.error());
  }
  const auto sampler = [&](const char* name, int samples) {
    rsdiff::SamplingOptions sampling;
    sampling.samples = samples;
    sampling.steps = options.steps;
    sampling.guidance = options.guidance.value_or(sampling.guidance);
    sampling.eta = options.eta.value_or(sampling.eta);
    return std::make_unique<SingleImageMethod>(name, *estimator, sampling, options.know_focal);
  };
  if (options.calibration_samples > 0) {
    set.sampler = sampler("calibration", options.calibration_samples);
  }
  set.skew = sampler(kMean, options.samples);
  return set;
}

}  // namespace

std::string PictureMethodNames() {
  return "none, gyro, gyro-onestep, diffusion, sample, mean, reference, regression, lines, "
         "homography-mixture, "
         "rotation-spline";
}

std::vector<std::string> MethodsWithoutWeights(const EvaluateOptions& options) {
  std::vector<std::string> names;
  const auto wanted = ParseMethodList(options.methods);
  if (!wanted) {
    return names;
  }
  for (const MethodSpec& method : *wanted) {
    if (LacksWeights(options, method)) {
      names.push_back(method.text);
    }
  }
  return names;
}

Result<MethodFactory> MakeMethodFactory(const EvaluateOptions& options) {
  if (options.calibration_samples > 0 &&
      options.calibration_samples < evaluation::kLeastCoverageSamples) {
    return Fail(ErrorCode::kInvalidArgument,
                "--calibration-samples: the spread of {} samples says too little; give at least "
                "{}, or 0 to leave this out.",
                options.calibration_samples, evaluation::kLeastCoverageSamples);
  }
  auto wanted = ParseMethodList(options.methods);
  if (!wanted) {
    return Propagate(wanted.error());
  }
  // Pictures as they are always come first; networks without weights are not asked.
  std::erase_if(*wanted, [&](const MethodSpec& method) {
    return method.text == kNone || LacksWeights(options, method);
  });
  // Loading once here tells what is wrong before any photograph is decoded.
  if (auto tried = MakeMethods(options, *wanted); !tried) {
    return Propagate(tried.error());
  }
  return MethodFactory([options, wanted = *wanted] { return MakeMethods(options, wanted); });
}

}  // namespace rsstab::cli
