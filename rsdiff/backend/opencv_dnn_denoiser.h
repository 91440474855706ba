// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_BACKEND_OPENCV_DNN_DENOISER_H_
#define RSSTAB_RSDIFF_BACKEND_OPENCV_DNN_DENOISER_H_

#include <memory>

#include "igf/base/result.h"
#include "rsdiff/backend/backend_options.h"
#include "rsdiff/denoiser.h"
#include "rsdiff/model_file.h"

namespace rsstab::rsdiff {

// ONNX networks run by OpenCV DNN. The encoder takes "condition" (1 x C x R x K) and gives
// features, once per image. A denoiser takes "x" (S x 3 x B x 1), "t" (S x E, see TimeEmbedding)
// and "features" (as the encoder gave them; all zero = without the image) and gives the prediction.
// It is exported for fixed batch sizes S; a batch of states runs in pieces, the last one padded.
// Errors: as LoadDenoiser.
[[nodiscard]] Result<std::unique_ptr<Denoiser>> LoadOpenCvDnnDenoiser(
    const ModelInfo& model, const BackendOptions& options);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_BACKEND_OPENCV_DNN_DENOISER_H_
