// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_BACKEND_TORCH_DENOISER_H_
#define RSSTAB_RSDIFF_BACKEND_TORCH_DENOISER_H_

#include <memory>

#include "igf/base/result.h"
#include "rsdiff/backend/backend_options.h"
#include "rsdiff/denoiser.h"
#include "rsdiff/model_file.h"

namespace rsstab::rsdiff {

// A TorchScript network of any size, run by libtorch, as rsdiff/train/convert_checkpoint.py writes
// it. It has two methods, N samples sharing one image:
//   encode(condition 1 x channels x rows x columns) -> list of features
//   denoise(x N x C x rows x columns, time N (int64), features, drop N (bool)) -> prediction as x
// `drop` set is a prediction without the condition. (The published network then keeps the image and
// drops its class, which is how its authors guide it.)
// Devices: "cpu"; "cuda" where libtorch has it; "auto", which is the better of the two.
// Errors: as LoadDenoiser.
[[nodiscard]] Result<std::unique_ptr<Denoiser>> LoadTorchDenoiser(const ModelInfo& model,
                                                                  const BackendOptions& options);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_BACKEND_TORCH_DENOISER_H_
