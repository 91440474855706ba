// SPDX-License-Identifier: Apache-2.0
// From one 8-bit 4:2:0 picture to its motion field with the default model: preparing the picture,
// then everything, by samples, steps and threads. Budget: 12 ms for one sample in 4 steps.
//   single_image_motion_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>

#include "rsdiff/condition_image.h"
#include "rsdiff/model_path.h"
#include "rsdiff/orientation_planes.h"
#include "rsdiff/single_image_motion.h"

namespace rsstab::rsdiff {
namespace {

// Waves with some grain, so that every cell has edges to measure.
Frame PaintPicture(int width, int height) {
  Frame frame = AllocateFrame(Yuv420Layout(), width, height).value();
  for (int p = 0; p < frame.layout.num_planes; ++p) {
    const MutablePlaneView& plane = frame.planes[static_cast<std::size_t>(p)];
    for (int y = 0; y < plane.height; ++y) {
      for (int x = 0; x < plane.width; ++x) {
        const double wave = std::sin(0.31 * x + 0.01 * y) * std::sin(0.23 * y);
        plane.data[y * plane.stride + x] =
            static_cast<std::uint8_t>(120.0 + 60.0 * wave + (x * 7919 + y * 104729) % 13);
      }
    }
  }
  return frame;
}

void Condition(benchmark::State& state, int width, int height) {
  const Frame picture = PaintPicture(width, height);
  for (auto _ : state) {
    const auto condition =
        MakeCondition(picture.View(), ConditionKind::kOrientationPlanes, kOrientationShape);
    benchmark::DoNotOptimize(condition->values.data());
  }
}

void Estimate(benchmark::State& state) {
  const auto path = FindModel();
  auto estimator = path ? SingleImageEstimator::Load(*path)
                        : Result<SingleImageEstimator>(tl::unexpected(path.error()));
  if (!estimator) {
    state.SkipWithError(estimator.error().message.c_str());
    return;
  }
  const Frame picture = PaintPicture(800, 600);
  SamplingOptions options;
  options.samples = static_cast<int>(state.range(0));
  options.steps = static_cast<int>(state.range(1));
  const int usual_threads = cv::getNumThreads();
  cv::setNumThreads(static_cast<int>(state.range(2)));
  for (auto _ : state) {
    const auto motion = estimator->Estimate(picture.View(), options);
    if (!motion) {
      state.SkipWithError(motion.error().message.c_str());
      break;
    }
    benchmark::DoNotOptimize(motion->spread_px);
  }
  cv::setNumThreads(usual_threads);
}

// Wall time, since OpenCV spreads a network over its threads; the processor's time beside it.
BENCHMARK_CAPTURE(Condition, 800x600, 800, 600)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Condition, 1920x1080, 1920, 1080)->Unit(benchmark::kMillisecond);
BENCHMARK(Estimate)
    ->ArgNames({"samples", "steps", "threads"})
    ->ArgsProduct({{1, 8, 16}, {1, 2, 4, 8}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace rsstab::rsdiff
