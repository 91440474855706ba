// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PATH_CROP_LIMIT_DETAIL_H_
#define RSSTAB_STABILIZER_PATH_CROP_LIMIT_DETAIL_H_

#include "igf/base/result.h"
#include "stabilizer/path_smoother.h"
#include "stabilizer/path_window_detail.h"

namespace rsstab::stabilizer {

// Solves for the global update of the window's open frames such that a window of min_crop_ratio
// stays inside the picture and the picture keeps its shape: as strictly as the look-ahead makes
// sense of, following the camera closer where there is no other way. Errors: kInternal.
[[nodiscard]] Status SolvePathWithinCrop(const PathSmootherOptions& options, PathWindow& window);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_PATH_CROP_LIMIT_DETAIL_H_
