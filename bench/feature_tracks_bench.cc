// SPDX-License-Identifier: Apache-2.0
// From the luma of a 1920x1080 frame to its tracks, wall and processor time of all threads. Budget:
// 12 ms of processor time a frame, of which 2 ms are the proxy's.
//   feature_tracks_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <memory>
#include <utility>

#include "bench/shaky_warp.h"
#include "igf/motion_presets.h"
#include "igf/rs_simulator.h"
#include "igf/scene_painter.h"
#include "stabilizer/feature_tracks.h"

namespace rsstab::stabilizer {
namespace {

constexpr double kFrameIntervalS = 1.0 / 30.0;
constexpr int kFrames = 12;

// A walk along a painted street.
std::vector<Frame> StreetFrames(int bit_depth) {
  constexpr double kDurationS = kFrames * kFrameIntervalS;
  const auto picture = igf::PaintStreet(4096, 1024, 1);
  auto scene = std::make_shared<const igf::TextureScene>(
      igf::TextureScene::FromPicture(picture.value(), igf::kPaintedWidthTan, bench::kFocalPx)
          .value());
  igf::RsSimulatorOptions options;
  options.readout_s = igf::UsualReadout(igf::MotionPreset::kWalking);
  options.noise_sigma = 1.0;
  const auto simulator =
      igf::RsSimulator::Create(
          std::move(scene), Camera::Pinhole(bench::kWidth, bench::kHeight, bench::kFocalPx),
          igf::MakePresetOrientation(igf::MotionPreset::kWalking, 1, kDurationS).value(), options)
          .value();
  WorkerPool pool(ResolveThreadCount(0));
  std::vector<Frame> frames;
  frames.reserve(kFrames);
  for (int i = 0; i < kFrames; ++i) {
    frames.push_back(
        simulator.RenderRs(i * kFrameIntervalS, GrayLayout(bit_depth), pool, i).value());
  }
  return frames;
}

// Forwards and backwards through the clip, so that every frame neighbours the one before.
std::size_t Bounce(int step) {
  constexpr int kPeriod = 2 * (kFrames - 1);
  const int phase = step % kPeriod;
  return static_cast<std::size_t>(phase < kFrames ? phase : kPeriod - phase);
}

void Proxy(benchmark::State& state, int bit_depth) {
  const std::vector<Frame> frames = StreetFrames(bit_depth);
  int step = 0;
  for (auto _ : state) {
    const auto proxy = MakeLumaProxy(frames[Bounce(step++)].View());
    if (!proxy) {
      state.SkipWithError(proxy.error().message.c_str());
      break;
    }
    benchmark::DoNotOptimize(proxy->pixels.data());
  }
}

void LumaToTracks(benchmark::State& state) {
  const std::vector<Frame> frames = StreetFrames(8);
  FeatureTracker tracker({});
  int step = 0;
  std::size_t matches = 0;
  for (auto _ : state) {
    const auto proxy = MakeLumaProxy(frames[Bounce(step)].View());
    const auto output = tracker.Push(proxy.value(), step * kFrameIntervalS);
    if (!output) {
      state.SkipWithError(output.error().message.c_str());
      break;
    }
    matches += output->tracks.matches.size();
    ++step;
  }
  state.counters["tracks"] =
      benchmark::Counter(static_cast<double>(matches), benchmark::Counter::kAvgIterations);
}

const bool kRegistered = [] {
  const auto in_ms = [](benchmark::internal::Benchmark* b) {
    b->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
  };
  in_ms(benchmark::RegisterBenchmark("luma_proxy/8_bit", Proxy, 8));
  in_ms(benchmark::RegisterBenchmark("luma_proxy/10_bit", Proxy, 10));
  in_ms(benchmark::RegisterBenchmark("luma_to_tracks", LumaToTracks));
  return true;
}();

}  // namespace
}  // namespace rsstab::stabilizer
