// SPDX-License-Identifier: Apache-2.0
// The camera's rotation from tracks: 490 tracks a frame pair, as 1920x1080 footage gives. `frame`
// is the time per frame pair. Budget: 3 ms a frame for everything, of which 0.5 ms are the cells'
// (made twice) and 2 ms the fusion's; 1 s a clip for the calibration, whatever its length.
//   rs_motion_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "igf/motion_presets.h"
#include "stabilizer/clip_calibration.h"
#include "stabilizer/rs_motion_fusion.h"
#include "tests/stabilizer/shaky_camera.h"

namespace rsstab::stabilizer {
namespace {

using testing::RegularTimes;
using testing::ShakyCamera;
using testing::UsualJerkWeight;

constexpr int kTracks = 490;
constexpr int kWindowPairs = 45;  // as the fusion solves them
constexpr int kClipFrames = 240;
constexpr double kReadout = 0.02;

ShakyCamera Camera(igf::MotionPreset preset, int frames) {
  ShakyCamera camera(preset, kReadout, frames * testing::kFrameS);
  camera.track_options.matches_per_pair = kTracks;
  return camera;
}

RsMotionModel Model(const ShakyCamera& camera, igf::MotionPreset preset) {
  RsMotionModel model = camera.Model();
  model.jerk_weight = UsualJerkWeight(preset);
  return model;
}

// Time per frame pair.
void CountPairs(benchmark::State& state, std::size_t pairs) {
  state.counters["frame"] =
      benchmark::Counter(static_cast<double>(pairs), benchmark::Counter::kIsIterationInvariantRate |
                                                         benchmark::Counter::kInvert);
}

void Cells(benchmark::State& state) {
  const auto tracks = Camera(igf::MotionPreset::kWalking, 2).Tracks(RegularTimes(2)).front();
  for (auto _ : state) {
    benchmark::DoNotOptimize(SummarizeTracks(tracks, nullptr));
  }
}

RsMotionWindow MakeWindow(const RsMotionModel& model, const std::vector<FramePairCells>& pairs) {
  SplineStretch stretch;
  ExtendStretch(model, pairs, stretch);
  return {model, pairs, std::move(stretch), 1, {}};
}

void Build(benchmark::State& state, igf::MotionPreset preset) {
  const ShakyCamera camera = Camera(preset, kWindowPairs + 1);
  const auto pairs = camera.Pairs(RegularTimes(kWindowPairs + 1));
  const RsMotionModel model = Model(camera, preset);
  for (auto _ : state) {
    const RsMotionWindow window = MakeWindow(model, pairs);
    benchmark::DoNotOptimize(&window);
  }
  CountPairs(state, pairs.size());
}

void BuildAndSolve(benchmark::State& state, igf::MotionPreset preset) {
  const ShakyCamera camera = Camera(preset, kWindowPairs + 1);
  const auto pairs = camera.Pairs(RegularTimes(kWindowPairs + 1));
  const RsMotionModel model = Model(camera, preset);
  for (auto _ : state) {
    RsMotionWindow window = MakeWindow(model, pairs);
    if (!window.Solve(4)) {
      state.SkipWithError("the window could not be solved");
      break;
    }
  }
  CountPairs(state, pairs.size());
}

void Evidence(benchmark::State& state, igf::MotionPreset preset) {
  const ShakyCamera camera = Camera(preset, kWindowPairs + 1);
  const auto pairs = camera.Pairs(RegularTimes(kWindowPairs + 1));
  RsMotionWindow window = MakeWindow(Model(camera, preset), pairs);
  constexpr std::array<double, 6> kWeights = {0.003, 0.01, 0.03, 0.1, 0.3, 1.0};
  for (auto _ : state) {
    benchmark::DoNotOptimize(window.LogEvidence(kWeights));
  }
  CountPairs(state, pairs.size());
}

void Calibration(benchmark::State& state, igf::MotionPreset preset) {
  const auto pairs = Camera(preset, kClipFrames).Pairs(RegularTimes(kClipFrames));
  for (auto _ : state) {
    ClipCalibrator calibrator({});
    for (const FramePairCells& pair : pairs) {
      calibrator.Push(pair);
    }
    benchmark::DoNotOptimize(calibrator.Calibrate());
  }
}

void Fusion(benchmark::State& state, igf::MotionPreset preset) {
  const ShakyCamera camera = Camera(preset, kClipFrames);
  const auto times_s = RegularTimes(kClipFrames);
  auto pairs = camera.Pairs(times_s);
  pairs.insert(pairs.begin(), FramePairCells{});
  const RsMotionModel model = Model(camera, preset);
  for (auto _ : state) {
    RsMotionFusion fusion(model);
    std::size_t frames = 0;
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      fusion.Push(times_s[i], pairs[i]);
      frames += fusion.TakeReady().size();
    }
    fusion.Finish();
    frames += fusion.TakeReady().size();
    if (frames != times_s.size()) {
      state.SkipWithError("frames are missing");
      break;
    }
  }
  CountPairs(state, times_s.size());
}

const bool kRegistered = [] {
  const auto in_ms = [](benchmark::internal::Benchmark* b) {
    b->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
  };
  in_ms(benchmark::RegisterBenchmark("cells", Cells));
  for (const auto& [name, preset] : {std::pair("walking", igf::MotionPreset::kWalking),
                                     std::pair("vibration", igf::MotionPreset::kVibration)}) {
    const std::string ending = std::string("/") + name;
    in_ms(benchmark::RegisterBenchmark(("window_build" + ending).c_str(), Build, preset));
    in_ms(benchmark::RegisterBenchmark(("window_build_and_solve" + ending).c_str(), BuildAndSolve,
                                       preset));
    in_ms(benchmark::RegisterBenchmark(("window_evidence" + ending).c_str(), Evidence, preset));
    in_ms(benchmark::RegisterBenchmark(("calibration" + ending).c_str(), Calibration, preset));
    in_ms(benchmark::RegisterBenchmark(("fusion" + ending).c_str(), Fusion, preset));
  }
  return true;
}();

}  // namespace
}  // namespace rsstab::stabilizer
