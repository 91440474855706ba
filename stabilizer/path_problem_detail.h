// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_PATH_PROBLEM_DETAIL_H_
#define RSSTAB_STABILIZER_PATH_PROBLEM_DETAIL_H_

#include "igf/base/result.h"
#include "stabilizer/path_smoother.h"
#include "stabilizer/path_window_detail.h"

namespace rsstab::stabilizer {

// Solves for the global update (theta) of the window's open frames, by least squares over the terms
// of path_residuals.h; what is decided is held. `crop_weight`: penalty on corners beyond the crop
// limit. Begins where theta stands. Errors: kInternal.
[[nodiscard]] Status SolvePath(const PathSmootherOptions& options, double crop_weight,
                               PathWindow& window);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_PATH_PROBLEM_DETAIL_H_
