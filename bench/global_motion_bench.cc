// SPDX-License-Identifier: Apache-2.0
// The motion that 500 matches between two frames share. Budget: 1 ms a frame.
//   global_motion_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include "bench/synthetic_matches.h"
#include "stabilizer/global_motion.h"

namespace rsstab::stabilizer {
namespace {

void Estimate(benchmark::State& state, MotionRung finest) {
  const std::vector<RectifiedMatch> matches = bench::SyntheticMatches();
  GlobalMotionOptions options;
  options.finest = finest;
  for (auto _ : state) {
    const GlobalMotion motion = EstimateGlobalMotion(matches, options);
    if (motion.rung != finest) {
      state.SkipWithError("the matches do not support the motion");
      break;
    }
    benchmark::DoNotOptimize(motion.to_from);
  }
}

const bool kRegistered = [] {
  benchmark::RegisterBenchmark("global_motion/homography", Estimate, MotionRung::kHomography)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("global_motion/similarity", Estimate, MotionRung::kSimilarity)
      ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace rsstab::stabilizer
