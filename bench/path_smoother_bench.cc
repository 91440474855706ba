// SPDX-License-Identifier: Apache-2.0
// Smoothing 20 s of shake at 30 frames a second; `frame` is the time per frame. Budget: 3 ms a
// frame, 10 ms for the last one, whose long smoothing keeps meeting a narrow crop limit.
//   path_smoother_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "igf/base/rotation.h"
#include "igf/motion_presets.h"
#include "stabilizer/mesh_grid.h"
#include "stabilizer/normalized_coordinates.h"
#include "stabilizer/path_smoother.h"

namespace rsstab::stabilizer {
namespace {

constexpr int kFrames = 600;
constexpr double kFramesPerSecond = 30.0;

struct Shake {
  igf::MotionPreset preset;
  double parallax_px = 0.0;  // local motion between two frames, at kReferenceWidthPx
  double smoothness_s = 1.0;
  double min_crop_ratio = 0.8;
};

std::vector<FrameMotion> Motions(const Shake& shake, const PathSmootherOptions& options) {
  const igf::PresetMotion camera(shake.preset, 1, kFrames / kFramesPerSecond);
  const MeshGrid mesh(options.mesh_columns, options.mesh_rows, options.aspect);
  const Eigen::Matrix3d k =
      Eigen::Vector3d(options.focal_ratio, options.focal_ratio, 1.0).asDiagonal();
  std::vector<FrameMotion> motions(kFrames);
  motions[0].path_begins = true;
  for (int i = 1; i < kFrames; ++i) {
    FrameMotion& motion = motions[static_cast<std::size_t>(i)];
    const double t = i / kFramesPerSecond;
    const Eigen::Quaterniond from = camera.WorldFromCamera(t - 1.0 / kFramesPerSecond).conjugate();
    const Eigen::Quaterniond to = camera.WorldFromCamera(t).conjugate();
    motion.to_from = RotationHomography(k, to, from);
    motion.rung = shake.parallax_px > 0.0 ? MotionRung::kMesh : MotionRung::kHomography;
    if (shake.parallax_px == 0.0) {
      continue;
    }
    // Depth in waves across the picture, seen from a camera that sways at 2 Hz.
    const double sway =
        shake.parallax_px / kReferenceWidthPx * std::cos(4.0 * std::numbers::pi * t);
    for (int row = 0; row <= mesh.rows(); ++row) {
      for (int column = 0; column <= mesh.columns(); ++column) {
        const Eigen::Vector2d p = mesh.VertexPosition(column, row);
        motion.local.emplace_back(sway * std::sin(2.0 * std::numbers::pi * p.x()),
                                  0.5 * sway * std::cos(4.0 * p.y()));
      }
    }
  }
  return motions;
}

void Smooth(benchmark::State& state, const Shake& shake) {
  PathSmootherOptions options;
  options.frames_per_second = kFramesPerSecond;
  options.smoothness_s = shake.smoothness_s;
  options.min_crop_ratio = shake.min_crop_ratio;
  const std::vector<FrameMotion> motions = Motions(shake, options);
  for (auto _ : state) {
    const auto smoother = MakeCeresPathSmoother(options).value();
    std::size_t updates = 0;
    bool ok = true;
    for (const FrameMotion& motion : motions) {
      ok = ok && smoother->Push(motion).has_value();
      updates += smoother->TakeReady().size();
    }
    ok = ok && smoother->Finish().has_value();
    updates += smoother->TakeReady().size();
    if (!ok || updates != motions.size()) {
      state.SkipWithError("the path could not be smoothed");
      break;
    }
  }
  state.counters["frame"] = benchmark::Counter(
      kFrames, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const bool kRegistered = [] {
  const auto add = [](const char* name, const Shake& shake) {
    benchmark::RegisterBenchmark(name, Smooth, shake)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
  };
  add("path_smoother/handheld", {igf::MotionPreset::kHandheld});
  add("path_smoother/handheld_parallax", {igf::MotionPreset::kHandheld, 1.0});
  add("path_smoother/walking_parallax", {igf::MotionPreset::kWalking, 1.0});
  add("path_smoother/whip_pans_parallax", {igf::MotionPreset::kFastPan, 1.0});
  add("path_smoother/walking_parallax_3_s_crop_0.95",
      {igf::MotionPreset::kWalking, 1.0, 3.0, 0.95});
  return true;
}();

}  // namespace
}  // namespace rsstab::stabilizer
