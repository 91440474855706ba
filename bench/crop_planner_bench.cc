// SPDX-License-Identifier: Apache-2.0
// The largest crop window of a 1920x1080 frame that shows no border. Budget: 1 ms a frame.
//   crop_planner_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include "bench/shaky_warp.h"
#include "stabilizer/crop_planner.h"

namespace rsstab::stabilizer {
namespace {

void CropRatio(benchmark::State& state, bool with_lens) {
  FrameWarp warp = bench::ShakyWarp(1.0);
  if (with_lens) {
    warp.lens = bench::FisheyeLens();
  }
  for (auto _ : state) {
    const double ratio = LargestCropRatio(warp);
    if (!(ratio > kMinCropRatio && ratio < 1.0)) {
      state.SkipWithError("nothing to search for");
      break;
    }
    benchmark::DoNotOptimize(ratio);
  }
}

const bool kRegistered = [] {
  benchmark::RegisterBenchmark("crop_ratio/pinhole", CropRatio, false)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("crop_ratio/fisheye", CropRatio, true)
      ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace rsstab::stabilizer
