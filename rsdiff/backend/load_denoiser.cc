// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/backend/load_denoiser.h"

#include "rsdiff/backend/opencv_dnn_denoiser.h"
#ifdef RSSTAB_WITH_TORCH
#include "rsdiff/backend/torch_denoiser.h"
#endif

namespace rsstab::rsdiff {

Result<std::unique_ptr<Denoiser>> LoadDenoiser(const ModelInfo& model,
                                               const BackendOptions& options) {
  switch (model.library) {
    case NetworkLibrary::kOpenCvDnn:
      return LoadOpenCvDnnDenoiser(model, options);
    case NetworkLibrary::kTorch:
#ifdef RSSTAB_WITH_TORCH
      return LoadTorchDenoiser(model, options);
#else
      return Fail(ErrorCode::kUnsupported,
                  "model {} needs libtorch, and this program was built without it; build it with "
                  "-DRSSTAB_WITH_TORCH=ON (Debian package libtorch-dev)",
                  model.file.string());
#endif
  }
  return Fail(ErrorCode::kInternal, "model {} names no network library", model.file.string());
}

}  // namespace rsstab::rsdiff
