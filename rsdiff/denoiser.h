// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_DENOISER_H_
#define RSSTAB_RSDIFF_DENOISER_H_

#include "igf/base/result.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

// Whether a prediction looks at the image. Training drops the image now and then, so that a network
// can also be asked without; guidance extrapolates from one to the other.
enum class Conditioning { kWithImage, kWithoutImage };

// A diffusion network: (noisy motion states, time step, image) -> prediction of its objective (x0,
// noise or v; which one is the sampler's business). Hides the network library. Motion states are in
// network units: rotation curves 3 x bands x 1, dense fields 2 x rows x columns.
// Not thread safe: one caller at a time.
class Denoiser {
 public:
  virtual ~Denoiser() = default;

  // Shape of one motion state, and of the condition that Encode takes.
  [[nodiscard]] virtual Shape StateShape() const = 0;
  [[nodiscard]] virtual Shape ConditionShape() const = 0;

  // Takes the condition of one image (batch 1; see condition_image.h) for the Predict calls that
  // follow, once per image.
  // Errors: kInvalidArgument for another shape; kInternal when the network library fails.
  [[nodiscard]] virtual Status Encode(const Tensor& condition) = 0;

  // Prediction for a batch of states, all at time step `t` in [0, T). Same shape as `states`.
  // Errors: kInvalidArgument for another shape, an empty batch, or an image that was never encoded;
  // kInternal when the network library fails.
  [[nodiscard]] virtual Result<Tensor> Predict(const Tensor& states, int t,
                                               Conditioning conditioning) = 0;
};

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_DENOISER_H_
