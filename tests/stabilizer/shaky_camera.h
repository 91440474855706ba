// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_STABILIZER_SHAKY_CAMERA_H_
#define RSSTAB_TESTS_STABILIZER_SHAKY_CAMERA_H_

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "igf/motion_presets.h"
#include "stabilizer/rs_motion_window.h"
#include "stabilizer/track_cells.h"
#include "tests/igf/synthetic_tracks.h"

namespace rsstab::stabilizer::testing {

inline constexpr int kWidth = 640;
inline constexpr int kHeight = 360;
inline constexpr double kFocal = 0.866;  // picture widths: 60 degrees across
inline constexpr double kFrameS = 1.0 / 30.0;

inline Camera TestCamera() { return Camera::Pinhole(kWidth, kHeight, kFocal * kWidth); }

// A camera that turns in a known way, and what a tracker sees of it.
struct ShakyCamera {
  ShakyCamera(igf::MotionPreset preset, double readout, double duration_s = 4.0, unsigned seed = 1)
      : truth(igf::MakePresetOrientation(preset, seed, duration_s).value()), readout_s(readout) {
    track_options.readout_s = readout;
    track_options.matches_per_pair = 300;
    track_options.noise_px = 0.1;
    track_options.outlier_ratio = 0.1;
    track_options.seed = seed;
  }

  igf::OrientationTrack truth;
  double readout_s;
  igf::testing::SyntheticTrackOptions track_options;

  // Tracks between consecutive ones of `times_s`, one entry fewer.
  [[nodiscard]] std::vector<PointTracks> Tracks(const std::vector<double>& times_s) const {
    std::mt19937 random(track_options.seed);
    std::vector<PointTracks> tracks;
    for (std::size_t i = 1; i < times_s.size(); ++i) {
      tracks.push_back(igf::testing::MakePairTracks(TestCamera(), truth, times_s[i - 1], times_s[i],
                                                    track_options, random));
    }
    return tracks;
  }

  [[nodiscard]] std::vector<FramePairCells> Pairs(const std::vector<double>& times_s) const {
    std::vector<FramePairCells> pairs;
    for (const PointTracks& tracks : Tracks(times_s)) {
      pairs.push_back(SummarizeTracks(tracks, nullptr));
    }
    return pairs;
  }

  [[nodiscard]] RsMotionModel Model() const {
    RsMotionModel model;
    model.frame_interval_s = kFrameS;
    model.readout_s = readout_s;
    model.focal = kFocal;
    return model;
  }

  // px at 640 px width: how far rows are from where a spline puts them against the middle row, the
  // largest over one frame. `camera_from_world(t)`: the spline.
  template <typename Spline>
  [[nodiscard]] double RowError(const Spline& camera_from_world, double frame_time_s) const {
    const auto middle = camera_from_world(frame_time_s);
    const auto true_middle = truth.CameraFromWorld(frame_time_s);
    double worst = 0.0;
    for (int i = -8; i <= 8; ++i) {
      const double t = frame_time_s + readout_s * i / 16.0;
      const Eigen::Quaterniond row = camera_from_world(t) * middle.conjugate();
      const Eigen::Quaterniond true_row = *truth.CameraFromWorld(t) * true_middle->conjugate();
      worst = std::max(worst, row.angularDistance(true_row));
    }
    return worst * kFocal * kWidth;
  }

  // The same for a camera that is taken to stand still: what is there to correct.
  [[nodiscard]] double RowMotion(double frame_time_s) const {
    return RowError([](double) { return Eigen::Quaterniond::Identity(); }, frame_time_s);
  }
};

inline std::vector<double> RegularTimes(int frames, double start_s = 0.0) {
  std::vector<double> times_s;
  for (int i = 0; i < frames; ++i) {
    times_s.push_back(start_s + i * kFrameS);
  }
  return times_s;
}

// About how stiff a preset's motion is (RsMotionModel::jerk_weight).
inline double UsualJerkWeight(igf::MotionPreset preset) {
  return preset == igf::MotionPreset::kVibration ? 0.01 : 0.3;
}

inline double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) {
    sum += v * v;
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace rsstab::stabilizer::testing

#endif  // RSSTAB_TESTS_STABILIZER_SHAKY_CAMERA_H_
