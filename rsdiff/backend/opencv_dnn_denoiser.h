// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_BACKEND_OPENCV_DNN_DENOISER_H_
#define RSSTAB_RSDIFF_BACKEND_OPENCV_DNN_DENOISER_H_

#include <memory>

#include "igf/base/result.h"
#include "rsdiff/backend/backend_options.h"
#include "rsdiff/denoiser.h"
#include "rsdiff/model_file.h"

namespace rsstab::rsdiff {

// ONNX networks of fixed shapes, run by OpenCV DNN. For motion states of C x B x K (rotation
// curves: 3 x bands x 1):
//   encoder:   "condition" 1 x channels x rows x columns  ->  features 1 x F x ...
//   denoiser:  "x" S x C x B x K, "time" S x E x B x 1 (TimeEmbedding, the same on every row) and
//              "features" S x F x ...  ->  prediction S x C x B x K
// The encoder runs once per image. Without the image the features are all zero. A denoiser is
// exported for a fixed batch size S, or for several; a batch of states runs in pieces of the size
// that needs fewest of them, the last one padded.
// Errors: as LoadDenoiser.
[[nodiscard]] Result<std::unique_ptr<Denoiser>> LoadOpenCvDnnDenoiser(
    const ModelInfo& model, const BackendOptions& options);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_BACKEND_OPENCV_DNN_DENOISER_H_
