// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/evaluate_methods.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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

constexpr std::string_view kNone = "none";
constexpr std::string_view kGyro = "gyro";
constexpr std::string_view kGyroOneStep = "gyro-onestep";
constexpr std::string_view kLines = "lines";
constexpr std::string_view kHomographyMixture = "homography-mixture";
constexpr std::string_view kRotationSpline = "rotation-spline";
constexpr std::string_view kRegression = "regression";
constexpr std::string_view kSample = "sample";
constexpr std::string_view kMean = "mean";
constexpr std::string_view kDiffusion = "diffusion";
constexpr std::string_view kReference = "reference";

// Every method of pictures: help and messages are made from this table.
struct PictureMethod {
  std::string_view name;
  bool is_network;
  const char* what;
};
constexpr std::array<PictureMethod, 11> kPictureMethods = {
    {{kNone, false, "the picture as it is; always there"},
     {kGyro, false, "the exact motion of a gyro log"},
     {kGyroOneStep, false, "the same by row bands, as in gyro-onestep@bands=60"},
     {kDiffusion, true,
      "mean of the model's samples; settings may follow, as in diffusion@steps=1,samples=8"},
     {kMean, true, "another word for diffusion"},
     {kSample, true, "one of its samples"},
     {kReference, true, "the network that --reference-model names"},
     {kRegression, true, "one sample of the network that --regression-model names"},
     {kLines, false, "straight edges of the picture alone"},
     {kHomographyMixture, false, "where there is a frame before or after"},
     {kRotationSpline, false, "the same"}}};

const PictureMethod* FindMethod(const std::string& name) {
  const auto* const found =
      std::find_if(kPictureMethods.begin(), kPictureMethods.end(),
                   [&](const PictureMethod& method) { return method.name == name; });
  return found == kPictureMethods.end() ? nullptr : found;
}

bool IsNetwork(const std::string& name) {
  const PictureMethod* const method = FindMethod(name);
  return method != nullptr && method->is_network;
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

// Row bands of gyro-onestep.
std::optional<int> BandsOf(const MethodSpec& method) {
  const auto bands = method.settings.find("bands");
  if (bands == method.settings.end()) {
    return method.settings.empty() ? std::optional<int>(evaluation::kUsualBands) : std::nullopt;
  }
  const auto number = pipeline::ParseInteger(bands->second);
  const bool fits = method.settings.size() == 1 && number && *number >= 1 && *number <= 65535;
  return fits ? std::optional<int>(static_cast<int>(*number)) : std::nullopt;
}

// Whether there is such a method, with such settings.
Status CheckMethod(const EvaluateOptions& options, const MethodSpec& method) {
  if (FindMethod(method.name) == nullptr) {
    return Fail(ErrorCode::kInvalidArgument, "--methods: there is no method '{}'; choose from {}.",
                method.name, PictureMethodNames());
  }
  if (method.name == kGyroOneStep) {
    return BandsOf(method) ? Status()
                           : Fail(ErrorCode::kInvalidArgument,
                                  "--methods: {}: its one setting is bands, a whole number from 1.",
                                  method.text);
  }
  const auto changed = WithSettings(options, method);
  return changed ? Status() : Status(Propagate(changed.error()));
}

// Of a method that CheckMethod lets pass, but for none.
Result<std::unique_ptr<evaluation::MotionMethod>> MakeMethod(const EvaluateOptions& options,
                                                             const MethodSpec& method,
                                                             Estimators& estimators) {
  if (IsNetwork(method.name)) {
    return MakeNetwork(options, method, estimators);
  }
  if (method.name == kGyroOneStep) {
    return std::make_unique<GyroMethod>(method.text, BandsOf(method).value());
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
  return std::make_unique<RotationSplineMethod>();
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
  const auto sampler = [&](std::string_view name, int samples) {
    rsdiff::SamplingOptions sampling;
    sampling.samples = samples;
    sampling.steps = options.steps;
    sampling.guidance = options.guidance.value_or(sampling.guidance);
    sampling.eta = options.eta.value_or(sampling.eta);
    return std::make_unique<SingleImageMethod>(std::string(name), *estimator, sampling,
                                               options.know_focal);
  };
  if (options.calibration_samples > 0) {
    set.sampler = sampler("calibration", options.calibration_samples);
  }
  set.skew = sampler(kMean, options.samples);
  return set;
}

}  // namespace

std::string PictureMethodNames() {
  std::string names;
  for (const PictureMethod& method : kPictureMethods) {
    names += (names.empty() ? "" : ", ") + std::string(method.name);
  }
  return names;
}

std::string PictureMethodHelp() {
  std::string help;
  for (const PictureMethod& method : kPictureMethods) {
    help += fmt::format("{}{} ({})", help.empty() ? "" : ", ", method.name, method.what);
  }
  return help;
}

std::string MethodsAskedFor(const EvaluateOptions& options) {
  const bool is_data_set = options.protocol == EvaluationProtocol::kPairs ||
                           options.protocol == EvaluationProtocol::kRsReal;
  return is_data_set && options.methods == EvaluateOptions().methods ? kDatasetMethods
                                                                     : options.methods;
}

Status CheckPictureMethods(const EvaluateOptions& options) {
  if (options.calibration_samples > 0 &&
      options.calibration_samples < evaluation::kLeastCoverageSamples) {
    return Fail(ErrorCode::kInvalidArgument,
                "--calibration-samples: the spread of {} samples says too little; give at least "
                "{}, or 0 to leave this out.",
                options.calibration_samples, evaluation::kLeastCoverageSamples);
  }
  const auto wanted = ParseMethodList(options.methods);
  if (!wanted) {
    return Propagate(wanted.error());
  }
  for (const MethodSpec& method : *wanted) {
    if (Status status = CheckMethod(options, method); !status) {
      return status;
    }
  }
  return {};
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
  if (Status status = CheckPictureMethods(options); !status) {
    return Propagate(status.error());
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
