// SPDX-License-Identifier: Apache-2.0
// Local motion of a 16x16 mesh from 500 matches. Budget: 1 ms a frame.
//   mesh_motion_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include "bench/synthetic_matches.h"
#include "stabilizer/mesh_motion.h"

namespace rsstab::stabilizer {
namespace {

void Solve(benchmark::State& state) {
  const std::vector<RectifiedMatch> matches = bench::SyntheticMatches();
  MeshMotionSolver solver(MeshGrid(16, 16, bench::kAspect));
  for (auto _ : state) {
    const auto displacement = solver.Solve(matches, bench::FrameToFrame());
    if (displacement.empty()) {
      state.SkipWithError("no local motion found");
      break;
    }
    benchmark::DoNotOptimize(displacement.data());
  }
}

const bool kRegistered = [] {
  benchmark::RegisterBenchmark("mesh_motion/16x16", Solve)->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace rsstab::stabilizer
