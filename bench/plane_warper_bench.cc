// SPDX-License-Identifier: Apache-2.0
// Rendering one 1920x1080 frame: composing its backward map, and resampling its planes on one core
// through the map of a rotated, zoomed and vibrating camera. Budget: 2 ms for the map, 10 ms for
// the three planes of 8-bit 4:2:0 with bicubic interpolation.
//   plane_warper_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <string>

#include "bench/shaky_warp.h"
#include "stabilizer/plane_warper.h"

namespace rsstab::stabilizer {
namespace {

using bench::kHeight;
using bench::kWidth;

constexpr double kZoom = 1.25;  // keeps every pixel inside

// Deterministic texture; the values do not matter for the speed.
void FillTexture(Frame& frame) {
  for (int p = 0; p < frame.layout.num_planes; ++p) {
    const MutablePlaneView& plane = frame.planes[static_cast<std::size_t>(p)];
    for (int y = 0; y < plane.height; ++y) {
      for (std::ptrdiff_t x = 0; x < plane.stride; ++x) {
        // Odd bytes are the upper halves of deep samples.
        const bool upper = frame.layout.bit_depth > 8 && x % 2 == 1;
        plane.data[y * plane.stride + x] =
            static_cast<std::uint8_t>(upper ? y & 1 : (x * 7 + std::ptrdiff_t{13} * y) & 0xFF);
      }
    }
  }
}

PixelLayout Nv12Layout() {
  PixelLayout layout = Yuv420Layout();
  layout.num_planes = 2;
  layout.channels = {1, 2, 1, 1};
  return layout;
}

void ComposeMap(benchmark::State& state, bool with_lens) {
  FrameWarp warp = bench::ShakyWarp(kZoom);
  if (with_lens) {
    warp.lens = bench::FisheyeLens();
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(ComposeBackwardMap(warp));
  }
}

void Warp(benchmark::State& state, const PixelLayout& layout, Interpolation interpolation,
          KernelSet kernels) {
  Frame source = AllocateFrame(layout, kWidth, kHeight).value();
  Frame output = AllocateFrame(layout, kWidth, kHeight).value();
  FillTexture(source);
  const BackwardMap map = ComposeBackwardMap(bench::ShakyWarp(kZoom));
  const PlaneWarper warper(kernels);
  WorkerPool one_thread(1);
  for (auto _ : state) {
    if (!warper.Warp(source.View(), map, interpolation, output, one_thread)) {
      state.SkipWithError("the warper refused the frame");
      break;
    }
    benchmark::ClobberMemory();
  }
}

struct NamedLayout {
  const char* name;
  PixelLayout layout;
};
struct NamedInterpolation {
  const char* name;
  Interpolation interpolation;
};

const bool kRegistered = [] {
  benchmark::RegisterBenchmark("compose/pinhole", ComposeMap, false)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("compose/fisheye", ComposeMap, true)->Unit(benchmark::kMillisecond);
  const NamedLayout layouts[] = {{"yuv420p", Yuv420Layout()},
                                 {"yuv420p10", Yuv420Layout(10)},
                                 {"nv12", Nv12Layout()},
                                 {"rgba", RgbaLayout()}};
  const NamedInterpolation interpolations[] = {{"bilinear", Interpolation::kBilinear},
                                               {"bicubic", Interpolation::kBicubic},
                                               {"lanczos", Interpolation::kLanczos}};
  const auto add = [&](const std::string& prefix, KernelSet kernels) {
    for (const auto& [layout_name, layout] : layouts) {
      for (const auto& [name, interpolation] : interpolations) {
        benchmark::RegisterBenchmark((prefix + layout_name + "/" + name).c_str(), Warp, layout,
                                     interpolation, kernels)
            ->Unit(benchmark::kMillisecond);
      }
    }
  };
  add("warp/", BestKernelSet());
  add("warp_portable/", KernelSet::kPortable);
  return true;
}();

}  // namespace
}  // namespace rsstab::stabilizer
