// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/ddim_sampler.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace rsstab::rsdiff {
namespace {

// The numbers of one time step, rounded to float32 as published checkpoints store them. All the
// arithmetic on states below is float32 in the published order: a network may amplify rounding many
// thousandfold, and fields then agree with the published ones only where every bit does.
struct StepTable {
  float signal_root;      // sqrt(a)
  float noise_root;       // sqrt(1 - a)
  float reciprocal_root;  // sqrt(1 / a)
  float ratio_root;       // sqrt(1 / a - 1)

  explicit StepTable(double signal)
      : signal_root(static_cast<float>(std::sqrt(signal))),
        noise_root(static_cast<float>(std::sqrt(1.0 - signal))),
        reciprocal_root(static_cast<float>(std::sqrt(1.0 / signal))),
        ratio_root(static_cast<float>(std::sqrt(1.0 / signal - 1.0))) {}

  [[nodiscard]] float CleanState(Objective objective, float state, float prediction) const {
    switch (objective) {
      case Objective::kX0:
        break;
      case Objective::kNoise:
        return reciprocal_root * state - ratio_root * prediction;
      case Objective::kV:
        return signal_root * state - noise_root * prediction;
    }
    return prediction;
  }
  [[nodiscard]] float Noise(float state, float x0) const {
    return (reciprocal_root * state - x0) / ratio_root;
  }
};

// How the next state is put together (Song et al. 2021, eq. 12 and 16).
struct NextState {
  float of_x0;
  float of_noise;
  float of_fresh;  // sigma: the DDPM deviation between the two times, times eta

  NextState(float signal, float next_signal, float eta)
      : of_x0(std::sqrt(next_signal)),
        of_fresh(eta * std::sqrt((1.0F - signal / next_signal) * (1.0F - next_signal) /
                                 (1.0F - signal))) {
    of_noise = std::sqrt(std::max(0.0F, 1.0F - next_signal - of_fresh * of_fresh));
  }
};

// Standard deviation over all elements (of a sample, hence n - 1).
double Deviation(std::span<const float> values) {
  if (values.size() < 2) {
    return 0.0;
  }
  double sum = 0.0;
  for (const float v : values) {
    sum += static_cast<double>(v);
  }
  const double mean = sum / static_cast<double>(values.size());
  double squares = 0.0;
  for (const float v : values) {
    const double d = static_cast<double>(v) - mean;
    squares += d * d;
  }
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

// Turns `null`, the prediction without the image, into the guided one.
void Guide(std::span<const float> with_image, const DdimOptions& options, std::span<float> null) {
  for (std::size_t i = 0; i < null.size(); ++i) {
    const auto unguided = static_cast<double>(null[i]);
    null[i] = static_cast<float>(unguided + options.guidance *
                                                (static_cast<double>(with_image[i]) - unguided));
  }
  const double phi = options.guidance_rescale;
  const double guided_deviation = Deviation(null);
  if (phi == 0.0 || !(guided_deviation > 0.0)) {
    return;
  }
  const double factor = phi * Deviation(with_image) / guided_deviation + (1.0 - phi);
  for (float& v : null) {
    v = static_cast<float>(factor * static_cast<double>(v));
  }
}

Status CheckOptions(const DdimOptions& options, int diffusion_steps) {
  if (options.steps < 1 || options.steps > diffusion_steps) {
    return Fail(ErrorCode::kInvalidArgument, "{} sampling steps must lie within 1 and {}",
                options.steps, diffusion_steps);
  }
  if (!(options.eta >= 0.0 && options.eta <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "eta {} must lie within 0 and 1", options.eta);
  }
  if (!(options.clip_range > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument, "clip range {} must lie above 0", options.clip_range);
  }
  if (!std::isfinite(options.guidance)) {
    return Fail(ErrorCode::kInvalidArgument, "guidance must be a finite number");
  }
  if (!(options.guidance_rescale >= 0.0 && options.guidance_rescale <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "guidance rescale {} must lie within 0 and 1",
                options.guidance_rescale);
  }
  return {};
}

}  // namespace

Result<Tensor> DdimSampler::PredictGuided(Denoiser& denoiser, const DdimOptions& options,
                                          const Tensor& states, int t) const {
  if (options.guidance == 0.0) {
    return denoiser.Predict(states, t, Conditioning::kWithoutImage);
  }
  auto with_image = denoiser.Predict(states, t, Conditioning::kWithImage);
  if (!with_image || options.guidance == 1.0) {
    return with_image;
  }
  auto guided = denoiser.Predict(states, t, Conditioning::kWithoutImage);
  if (!guided) {
    return guided;
  }
  for (int i = 0; i < guided->batch; ++i) {
    Guide(std::as_const(*with_image).Item(i), options, guided->Item(i));
  }
  return guided;
}

Result<Tensor> DdimSampler::Sample(Denoiser& denoiser, const DdimOptions& options, Tensor states,
                                   SeededNoise& noise) const {
  if (const Status valid = CheckOptions(options, schedule_.steps()); !valid) {
    return Propagate(valid.error(), "sampling");
  }
  if (states.batch < 1 || states.shape != denoiser.StateShape()) {
    return Fail(ErrorCode::kInvalidArgument,
                "sampling: {} states of {}x{}x{} do not fit a network of {}x{}x{}", states.batch,
                states.shape.channels, states.shape.rows, states.shape.columns,
                denoiser.StateShape().channels, denoiser.StateShape().rows,
                denoiser.StateShape().columns);
  }
  const auto clip_range = static_cast<float>(options.clip_range);
  Tensor fresh(states.batch, states.shape);
  for (const auto& [t, next_t] : DdimTimePairs(schedule_.steps(), options.steps)) {
    const auto prediction = PredictGuided(denoiser, options, states, t);
    if (!prediction) {
      return Propagate(prediction.error(), fmt::format("sampling, time step {}", t));
    }
    const StepTable table(schedule_.Signal(t));
    const bool is_last = next_t < 0;
    const NextState next(static_cast<float>(schedule_.Signal(t)),
                         is_last ? 1.0F : static_cast<float>(schedule_.Signal(next_t)),
                         static_cast<float>(options.eta));
    const bool is_noisy = !is_last && next.of_fresh > 0.0F;
    if (is_noisy) {
      noise.Fill(fresh);
    }
    for (std::size_t i = 0; i < states.values.size(); ++i) {
      float& state = states.values[i];
      float x0 = table.CleanState(objective_, state, prediction->values[i]);
      if (!std::isfinite(x0)) {
        return Fail(ErrorCode::kUntrustworthy,
                    "sampling, time step {}: the network returned a number that is not finite", t);
      }
      if (options.clip) {
        x0 = std::clamp(x0, -clip_range, clip_range);
      }
      if (is_last) {
        state = x0;
        continue;
      }
      state = x0 * next.of_x0 + next.of_noise * table.Noise(state, x0);
      if (is_noisy) {
        state += next.of_fresh * fresh.values[i];
      }
    }
  }
  return states;
}

}  // namespace rsstab::rsdiff
