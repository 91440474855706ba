// SPDX-License-Identifier: Apache-2.0
// The motion field of a vibrating camera's 1920x1080 frame, 17x65 vertices. Budget: 1 ms a frame.
//   intra_gyro_field_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include "bench/shaky_warp.h"
#include "igf/intra_gyro_field.h"
#include "igf/motion_presets.h"

namespace rsstab::igf {
namespace {

void Field(benchmark::State& state, const Camera& camera) {
  constexpr double kDurationS = 2.0;
  const auto track = MakePresetOrientation(MotionPreset::kVibration, 1, kDurationS);
  const double readout_s = UsualReadout(MotionPreset::kVibration);
  for (auto _ : state) {
    const auto field = ComputeIntraGyroField(camera, *track, 0.5 * kDurationS, readout_s);
    if (!field) {
      state.SkipWithError(field.error().message.c_str());
      break;
    }
    benchmark::DoNotOptimize(field->vertices().data());
  }
}

const bool kRegistered = [] {
  Camera brown = Camera::Pinhole(bench::kWidth, bench::kHeight, bench::kFocalPx);
  brown.model = LensModel::kBrown;
  brown.distortion = {-0.2, 0.05, 0.001, -0.002, -0.005};
  const Camera pinhole = Camera::Pinhole(bench::kWidth, bench::kHeight, bench::kFocalPx);
  const auto add = [](const char* name, const Camera& camera) {
    benchmark::RegisterBenchmark(name, Field, camera)->Unit(benchmark::kMillisecond);
  };
  add("intra_gyro_field/pinhole", pinhole);
  add("intra_gyro_field/fisheye", bench::FisheyeLens());
  add("intra_gyro_field/brown", brown);
  return true;
}();

}  // namespace
}  // namespace rsstab::igf
