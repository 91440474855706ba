// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/single_image_motion.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "igf/base/camera.h"
#include "rsdiff/backend/load_denoiser.h"
#include "rsdiff/condition_image.h"
#include "rsdiff/ddim_sampler.h"
#include "rsdiff/denoiser.h"
#include "rsdiff/dense_field.h"
#include "rsdiff/seeded_noise.h"

namespace rsstab::rsdiff {
namespace {

constexpr int kMaxSamples = 1024;

DdimOptions WithDefaults(const SamplingOptions& wanted, const DdimOptions& defaults) {
  DdimOptions options = defaults;
  if (wanted.steps > 0) {
    options.steps = wanted.steps;
  }
  if (wanted.guidance >= 0.0) {
    options.guidance = wanted.guidance;
  }
  if (wanted.eta >= 0.0) {
    options.eta = wanted.eta;
  }
  return options;
}

Status CheckOptions(const SamplingOptions& options) {
  if (options.samples < 1 || options.samples > kMaxSamples) {
    return Fail(ErrorCode::kInvalidArgument, "{} samples must lie within 1 and {}", options.samples,
                kMaxSamples);
  }
  if (options.steps < 0) {
    return Fail(ErrorCode::kInvalidArgument, "{} sampling steps must not be negative",
                options.steps);
  }
  if (!std::isfinite(options.guidance) || !std::isfinite(options.eta)) {
    return Fail(ErrorCode::kInvalidArgument, "guidance and eta must be finite numbers");
  }
  return {};
}

// Multiplies every sample's distance from their mean. A single sample stays where it is.
void SpreadOut(double scale, Tensor& samples) {
  if (scale == 1.0 || samples.batch < 2) {
    return;
  }
  const std::size_t size = samples.shape.Count();
  for (std::size_t i = 0; i < size; ++i) {
    double mean = 0.0;
    for (int s = 0; s < samples.batch; ++s) {
      mean += static_cast<double>(samples.Item(s)[i]) / samples.batch;
    }
    for (int s = 0; s < samples.batch; ++s) {
      float& value = samples.Item(s)[i];
      value = static_cast<float>(mean + scale * (static_cast<double>(value) - mean));
    }
  }
}

// The curve, zero at the middle row.
RotationCurve Centred(RotationCurve curve, int height) {
  const Eigen::Vector3d middle = CurveAtRow(curve, (height - 1) / 2.0, height);
  for (Eigen::Vector3d& value : curve) {
    value -= middle;
  }
  return curve;
}

// Fields of one grid -> their mean, and the deviation at every vertex.
void Summarise(const std::vector<MotionField>& fields, SingleImageMotion& motion) {
  const auto count = static_cast<double>(fields.size());
  motion.field = fields.front();
  const std::size_t vertices = motion.field.vertices().size();
  motion.vertex_spread_px.assign(vertices, std::numeric_limits<float>::infinity());
  motion.spread_px = std::numeric_limits<double>::infinity();
  double squares = 0.0;
  for (std::size_t v = 0; v < vertices; ++v) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const MotionField& field : fields) {
      mean += field.vertices()[v].cast<double>() / count;
    }
    motion.field.vertices()[v] = mean.cast<float>();
    if (fields.size() < 2) {
      continue;
    }
    double variance = 0.0;
    for (const MotionField& field : fields) {
      variance += (field.vertices()[v].cast<double>() - mean).squaredNorm() / (count - 1.0);
    }
    motion.vertex_spread_px[v] = static_cast<float>(std::sqrt(variance));
    squares += variance;
  }
  if (fields.size() >= 2) {
    motion.spread_px = std::sqrt(squares / static_cast<double>(vertices));
  }
}

void SummariseCurves(SingleImageMotion& motion) {
  const auto count = static_cast<double>(motion.curves.size());
  const std::size_t bands = motion.curves.front().size();
  motion.curve_mean.assign(bands, Eigen::Vector3d::Zero());
  motion.curve_deviation.assign(bands,
                                Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()));
  for (std::size_t band = 0; band < bands; ++band) {
    Eigen::Vector3d& mean = motion.curve_mean[band];
    for (const RotationCurve& curve : motion.curves) {
      mean += curve[band] / count;
    }
    if (motion.curves.size() < 2) {
      continue;
    }
    Eigen::Vector3d variance = Eigen::Vector3d::Zero();
    for (const RotationCurve& curve : motion.curves) {
      variance += (curve[band] - mean).cwiseAbs2() / (count - 1.0);
    }
    motion.curve_deviation[band] = variance.cwiseSqrt();
  }
}

}  // namespace

struct SingleImageEstimator::Impl {
  ModelInfo model;
  std::unique_ptr<Denoiser> denoiser;
  DdimSampler sampler;

  // The field of one sample.
  [[nodiscard]] Result<MotionField> Decode(std::span<const float> state, const Camera& camera,
                                           const FieldGrid& grid, SingleImageMotion& motion) const;
};

Result<MotionField> SingleImageEstimator::Impl::Decode(std::span<const float> state,
                                                       const Camera& camera, const FieldGrid& grid,
                                                       SingleImageMotion& motion) const {
  if (model.motion_kind == MotionKind::kRotationCurve) {
    motion.curves.push_back(Centred(CurveFromState(state, model.curve_scale), camera.height));
    return FieldFromCurve(motion.curves.back(), camera, grid);
  }
  const bool is_middle = model.reference_row == ReferenceRow::kMiddle;
  const double reference_row = is_middle ? (camera.height - 1) / 2.0 : 0.0;
  auto field =
      FieldFromDenseState(state, model.motion, camera.width, camera.height, reference_row, grid);
  if (!field || is_middle) {
    return field;
  }
  return WithMiddleReference(*field, camera);
}

SingleImageEstimator::SingleImageEstimator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SingleImageEstimator::SingleImageEstimator(SingleImageEstimator&&) noexcept = default;
SingleImageEstimator& SingleImageEstimator::operator=(SingleImageEstimator&&) noexcept = default;
SingleImageEstimator::~SingleImageEstimator() = default;

const ModelInfo& SingleImageEstimator::model() const { return impl_->model; }

Result<SingleImageEstimator> SingleImageEstimator::Load(const std::filesystem::path& model,
                                                        const BackendOptions& backend) {
  auto info = ReadModelFile(model);
  if (!info) {
    return Propagate(info.error());
  }
  auto denoiser = LoadDenoiser(*info, backend);
  if (!denoiser) {
    return Propagate(denoiser.error());
  }
  return Create(std::move(*info), std::move(*denoiser));
}

Result<SingleImageEstimator> SingleImageEstimator::Create(ModelInfo model,
                                                          std::unique_ptr<Denoiser> denoiser) {
  if (denoiser == nullptr || denoiser->StateShape() != model.motion ||
      denoiser->ConditionShape() != model.condition) {
    return Fail(ErrorCode::kInvalidArgument,
                "model {}: the network does not have the shapes that the model states",
                model.file.string());
  }
  auto schedule = NoiseSchedule::Create(model.schedule, model.diffusion_steps);
  if (!schedule) {
    return Propagate(schedule.error(), "model " + model.file.string());
  }
  const Objective objective = model.objective;
  return SingleImageEstimator(std::make_unique<Impl>(
      Impl{std::move(model), std::move(denoiser), DdimSampler(std::move(*schedule), objective)}));
}

Result<SingleImageMotion> SingleImageEstimator::Estimate(const FrameView& image,
                                                         const SamplingOptions& options,
                                                         std::optional<double> focal_px,
                                                         const FieldGrid& grid) {
  if (const Status valid = CheckOptions(options); !valid) {
    return Propagate(valid.error());
  }
  const ModelInfo& model = impl_->model;
  const auto condition = MakeCondition(image, model.condition_kind, model.condition);
  if (!condition) {
    return Propagate(condition.error());
  }
  const Camera camera = Camera::Pinhole(image.width, image.height, focal_px.value_or(image.width));
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error());
  }
  if (const Status encoded = impl_->denoiser->Encode(*condition); !encoded) {
    return Propagate(encoded.error());
  }
  SeededNoise noise(options.seed, options.samples);
  Tensor states(options.samples, model.motion);
  noise.Fill(states);
  auto sampled = impl_->sampler.Sample(*impl_->denoiser, WithDefaults(options, model.sampling),
                                       std::move(states), noise);
  if (!sampled) {
    return Propagate(sampled.error());
  }
  SpreadOut(model.spread_scale, *sampled);
  SingleImageMotion motion;
  std::vector<MotionField> fields;
  for (int i = 0; i < sampled->batch; ++i) {
    auto field = impl_->Decode(sampled->Item(i), camera, grid, motion);
    if (!field) {
      return Propagate(field.error());
    }
    fields.push_back(std::move(*field));
  }
  Summarise(fields, motion);
  if (!motion.curves.empty()) {
    SummariseCurves(motion);
  }
  return motion;
}

}  // namespace rsstab::rsdiff
