// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_STABILIZER_METRICS_METRIC_SOLVER_DETAIL_H_
#define RSSTAB_STABILIZER_METRICS_METRIC_SOLVER_DETAIL_H_

#include <ceres/ceres.h>

namespace rsstab::stabilizer {

// Solves a problem of few parameters on the calling thread: frame pairs are measured side by side.
// True when the solution is usable.
[[nodiscard]] inline bool SolveSmall(ceres::Problem& problem, int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable();
}

}  // namespace rsstab::stabilizer

#endif  // RSSTAB_STABILIZER_METRICS_METRIC_SOLVER_DETAIL_H_
