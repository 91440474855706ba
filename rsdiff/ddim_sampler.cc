// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/ddim_sampler.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace rsstab::rsdiff {
namespace {

// Coefficients that take a prediction to x0 = prediction * of_prediction + state * of_state.
struct X0Coefficients {
  double of_prediction;
  double of_state;
};

X0Coefficients CoefficientsOf(Objective objective, double signal) {
  const double a = std::sqrt(signal);
  const double s = std::sqrt(1.0 - signal);
  switch (objective) {
    case Objective::kX0:
      return {1.0, 0.0};
    case Objective::kNoise:  // x = a x0 + s noise
      return {-s / a, 1.0 / a};
    case Objective::kV:  // v = a noise - s x0
      return {-s, a};
  }
  return {1.0, 0.0};
}

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
  Tensor fresh(states.batch, states.shape);
  for (const auto& [t, next_t] : DdimTimePairs(schedule_.steps(), options.steps)) {
    const auto prediction = PredictGuided(denoiser, options, states, t);
    if (!prediction) {
      return Propagate(prediction.error(), fmt::format("sampling, time step {}", t));
    }
    const double signal = schedule_.Signal(t);
    const X0Coefficients x0_of = CoefficientsOf(objective_, signal);
    const bool is_last = next_t < 0;
    const double next_signal = is_last ? 1.0 : schedule_.Signal(next_t);
    // Song et al. 2021, eq. 16 and 12. sigma is the DDPM deviation between the two times, times
    // eta.
    const double sigma = options.eta * std::sqrt((1.0 - signal / next_signal) *
                                                 (1.0 - next_signal) / (1.0 - signal));
    const double of_noise = std::sqrt(std::max(0.0, 1.0 - next_signal - sigma * sigma));
    if (!is_last && sigma > 0.0) {
      noise.Fill(fresh);
    }
    for (std::size_t i = 0; i < states.values.size(); ++i) {
      const auto state = static_cast<double>(states.values[i]);
      double x0 =
          x0_of.of_prediction * static_cast<double>(prediction->values[i]) + x0_of.of_state * state;
      if (!std::isfinite(x0)) {
        return Fail(ErrorCode::kUntrustworthy,
                    "sampling, time step {}: the network returned a number that is not finite", t);
      }
      if (options.clip) {
        x0 = std::clamp(x0, -options.clip_range, options.clip_range);
      }
      if (is_last) {
        states.values[i] = static_cast<float>(x0);
        continue;
      }
      const double estimated_noise = (state - std::sqrt(signal) * x0) / std::sqrt(1.0 - signal);
      states.values[i] =
          static_cast<float>(std::sqrt(next_signal) * x0 + of_noise * estimated_noise +
                             sigma * static_cast<double>(fresh.values[i]));
    }
  }
  return states;
}

}  // namespace rsstab::rsdiff
