// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_LOCAL_PATH_PROBLEM_DETAIL_H_
#define RSSTAB_STABILIZER_LOCAL_PATH_PROBLEM_DETAIL_H_

#include "igf/base/result.h"
#include "stabilizer/path_smoother.h"
#include "stabilizer/path_window_detail.h"
#include "stabilizer/spatial_modes.h"

namespace rsstab::stabilizer {

// Solves for the smooth local paths (local_smooth) of the window's open frames, every spatial mode
// by itself; what is decided is held. A linear problem. Errors: kInternal.
[[nodiscard]] Status SolveLocalPaths(const PathSmootherOptions& options, const SpatialModes& modes,
                                     PathWindow& window);

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_LOCAL_PATH_PROBLEM_DETAIL_H_
