// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_DDIM_SAMPLER_H_
#define RSSTAB_RSDIFF_DDIM_SAMPLER_H_

#include "igf/base/result.h"
#include "rsdiff/denoiser.h"
#include "rsdiff/noise_schedule.h"
#include "rsdiff/seeded_noise.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

// What the network predicts.
enum class Objective {
  kX0,     // the clean state
  kNoise,  // the noise in x_t
  kV,      // sqrt(a_t) noise - sqrt(1 - a_t) x0 (Salimans & Ho 2022)
};

struct DdimOptions {
  int steps = 8;            // 1 .. T
  double eta = 0.0;         // 0 = deterministic after the first noise, 1 = as noisy as DDPM; >= 0
  bool clip = true;         // keep every estimate of x0 within +-clip_range
  double clip_range = 1.0;  // network units, above 0
  // Classifier-free guidance (Ho & Salimans 2022): null + guidance (with image - null). 1 = just
  // the prediction with the image (half the work), 0 = just the one without.
  double guidance = 1.0;
  // Share, 0 .. 1, of the guided prediction that is rescaled to the standard deviation of the
  // prediction with the image, per sample over all its elements (Lin et al. 2023, eq. 15-16).
  double guidance_rescale = 0.0;
};

// The reverse process of DDIM (Song et al. 2021, eq. 12) for a batch of states at once. Knows no
// network library. Const, but the denoiser it is given is not thread safe.
class DdimSampler {
 public:
  DdimSampler(NoiseSchedule schedule, Objective objective)
      : schedule_(std::move(schedule)), objective_(objective) {}

  // Turns `states`, pure noise of the denoiser's state shape, into samples. The image has been
  // encoded before. `noise` is asked at every step but the last, when eta > 0.
  // As in the implementation that the published one builds on, the noise estimate is worked out
  // again from the clipped x0, and the last step returns x0 itself.
  // Errors: kInvalidArgument for options outside their range or a shape that does not fit; those of
  // the denoiser; kUntrustworthy when the network returns numbers that are not finite.
  [[nodiscard]] Result<Tensor> Sample(Denoiser& denoiser, const DdimOptions& options, Tensor states,
                                      SeededNoise& noise) const;

  // The prediction of one step, guidance included.
  [[nodiscard]] Result<Tensor> PredictGuided(Denoiser& denoiser, const DdimOptions& options,
                                             const Tensor& states, int t) const;

  [[nodiscard]] const NoiseSchedule& schedule() const { return schedule_; }

 private:
  NoiseSchedule schedule_;
  Objective objective_;
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_DDIM_SAMPLER_H_
