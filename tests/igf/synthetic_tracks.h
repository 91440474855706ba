// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_IGF_SYNTHETIC_TRACKS_H_
#define RSSTAB_TESTS_IGF_SYNTHETIC_TRACKS_H_

#include <Eigen/Core>
#include <optional>
#include <random>
#include <vector>

#include "igf/base/camera.h"
#include "igf/base/point_tracks.h"
#include "igf/orientation_track.h"

namespace rsstab::igf::testing {

struct SyntheticTrackOptions {
  double frame_rate_hz = 30.0;
  double readout_s = 0.020;
  int matches_per_pair = 100;
  double noise_px = 0.15;      // standard deviation per axis, both frames
  double outlier_ratio = 0.2;  // matches with a displacement drawn from +-outlier_px
  double outlier_px = 15.0;
  unsigned seed = 1;
};

// Where a rolling-shutter frame shows a direction of the world: the pixel whose row is exposed at
// the instant when the direction projects to it. Written on its own, by plain iteration, so that
// tests do not judge the product by itself.
inline std::optional<Eigen::Vector2d> SeenAt(const Eigen::Vector3d& direction_in_world,
                                             const Camera& camera, const OrientationTrack& track,
                                             double frame_time_s, double readout_s) {
  double row = 0.5 * (camera.height - 1);
  std::optional<Eigen::Vector2d> pixel;
  for (int i = 0; i < 30; ++i) {
    const double t = frame_time_s + readout_s * ((row + 0.5) / camera.height - 0.5);
    const auto camera_from_world = track.CameraFromWorld(t);
    if (!camera_from_world) {
      return std::nullopt;
    }
    pixel = camera.ProjectRay(*camera_from_world * direction_in_world);
    if (!pixel) {
      return std::nullopt;
    }
    row = 0.5 * (row + pixel->y());  // damped: vibration may not contract
  }
  const bool inside = pixel->x() >= 0.0 && pixel->x() <= camera.width - 1.0 && pixel->y() >= 0.0 &&
                      pixel->y() <= camera.height - 1.0;
  return inside ? pixel : std::nullopt;
}

// Row-exact matches of random directions between two frames whose middle rows are exposed at the
// given times.
inline PointTracks MakePairTracks(const Camera& camera, const OrientationTrack& track,
                                  double from_time_s, double to_time_s,
                                  const SyntheticTrackOptions& options, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, options.noise_px);
  PointTracks pair{camera.width, camera.height, from_time_s, to_time_s, {}};
  for (int k = 0; k < options.matches_per_pair; ++k) {
    const Eigen::Vector2d pixel(unit(random) * (camera.width - 1),
                                unit(random) * (camera.height - 1));
    const Eigen::Vector3d direction =
        track.CameraFromWorld(from_time_s)->conjugate() * *camera.UnprojectPixel(pixel);
    const auto from = SeenAt(direction, camera, track, from_time_s, options.readout_s);
    auto to = SeenAt(direction, camera, track, to_time_s, options.readout_s);
    if (!from || !to) {
      continue;
    }
    if (unit(random) < options.outlier_ratio) {
      *to +=
          options.outlier_px * Eigen::Vector2d(2.0 * unit(random) - 1.0, 2.0 * unit(random) - 1.0);
    }
    const Eigen::Vector2d from_error(noise(random), noise(random));
    const Eigen::Vector2d to_error(noise(random), noise(random));
    pair.matches.push_back({(*from + from_error).cast<float>(), (*to + to_error).cast<float>()});
  }
  return pair;
}

// The same for consecutive frames at i / frame_rate, 0 <= i < duration * frame_rate.
inline std::vector<PointTracks> MakeTracks(const Camera& camera, const OrientationTrack& track,
                                           double duration_s,
                                           const SyntheticTrackOptions& options) {
  std::mt19937 random(options.seed);
  std::vector<PointTracks> result;
  const int frames = static_cast<int>(duration_s * options.frame_rate_hz);
  for (int i = 0; i + 1 < frames; ++i) {
    result.push_back(MakePairTracks(camera, track, i / options.frame_rate_hz,
                                    (i + 1) / options.frame_rate_hz, options, random));
  }
  return result;
}

}  // namespace rsstab::igf::testing

#endif  // RSSTAB_TESTS_IGF_SYNTHETIC_TRACKS_H_
