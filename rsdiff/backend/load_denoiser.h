// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_BACKEND_LOAD_DENOISER_H_
#define RSSTAB_RSDIFF_BACKEND_LOAD_DENOISER_H_

#include <memory>

#include "igf/base/result.h"
#include "rsdiff/backend/backend_options.h"
#include "rsdiff/denoiser.h"
#include "rsdiff/model_file.h"

namespace rsstab::rsdiff {

// Loads a model's weights, checksums verified, into the network library it names.
// Errors: those of ReadWeights; kUnsupported for a library that was not built in or a device that
// it does not have; kCorruptData for weights that are no such network.
[[nodiscard]] Result<std::unique_ptr<Denoiser>> LoadDenoiser(const ModelInfo& model,
                                                             const BackendOptions& options = {});

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_BACKEND_LOAD_DENOISER_H_
