// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_ORIENTATION_TRACK_H_
#define RSSTAB_IGF_ORIENTATION_TRACK_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::igf {

// A stretch of time; which ends belong to it is said where it is used.
struct TimeSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

// A sample and the constant body rate that leads from it to the next one:
//   world_from_camera(t) = world_from_camera * exp(rate_rad_s (t - time_s)).
// What a solver needs to differentiate an orientation by its time.
struct OrientationAnchor {
  double time_s = 0.0;
  Eigen::Quaterniond world_from_camera = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();
};

// Where a camera looked, as a function of time: samples joined by SLERP (constant rate about a
// fixed axis between two samples). Valid over the half-open span [start_s(), end_s()), so that two
// tracks laid end to end cover every instant exactly once; less the inside of gaps, where nobody
// knows.
//
// Camera axes: x right, y down, z forward. Orientations come in as world_from_camera, the form that
// integrating body rates gives (q <- q exp(w dt)); they are inverted here, once, and leave as
// camera_from_world. Const methods may be called from several threads.
class OrientationTrack {
 public:
  // `times_s` in seconds, strictly increasing, at least two; `world_from_camera` as many
  // quaternions of any length above zero (normalised here). `gaps`: open intervals without
  // knowledge, in time order, disjoint; orientations on the two sides of one are not comparable.
  // Errors: kInvalidArgument naming the first sample that breaks a rule.
  [[nodiscard]] static Result<OrientationTrack> Create(
      std::vector<double> times_s, std::vector<Eigen::Quaterniond> world_from_camera,
      std::vector<TimeSpan> gaps = {});

  [[nodiscard]] double start_s() const { return times_s_.front() + offset_s_; }
  [[nodiscard]] double end_s() const { return times_s_.back() + offset_s_; }

  // The samples, for those who store a track; i < num_samples(), times on the track's clock.
  [[nodiscard]] std::size_t num_samples() const { return times_s_.size(); }
  [[nodiscard]] double SampleTime(std::size_t i) const { return times_s_[i] + offset_s_; }
  [[nodiscard]] const Eigen::Quaterniond& SampleWorldFromCamera(std::size_t i) const {
    return world_from_camera_[i];
  }

  // True when [from_s, to_s] (either order) lies within the span and touches the inside of no gap:
  // orientations in it may be compared.
  [[nodiscard]] bool Covers(double from_s, double to_s) const;

  // R(t): world directions to camera directions. Empty outside the span and inside a gap.
  [[nodiscard]] std::optional<Eigen::Quaterniond> CameraFromWorld(double time_s) const;

  // Mean angular rate of the camera between two instants, rad/s, in the camera axes at `from_s`:
  // the constant body rate that leads from one orientation to the other. Empty unless to_s > from_s
  // and Covers(from_s, to_s).
  [[nodiscard]] std::optional<Eigen::Vector3d> MeanRate(double from_s, double to_s) const;

  // The sample interval that holds `time_s`; the first or last one for a time outside the span.
  // Asks nothing about gaps.
  [[nodiscard]] OrientationAnchor AnchorAt(double time_s) const;

  // The same motion on a clock that shows `offset_s` more: t_video = t_gyro + offset_s.
  [[nodiscard]] OrientationTrack WithOffset(double offset_s) const;

 private:
  OrientationTrack(std::vector<double> times_s, std::vector<Eigen::Quaterniond> world_from_camera,
                   std::vector<TimeSpan> gaps);

  // Index i with times_s_[i] <= t < times_s_[i + 1]; t, on the samples' clock, inside the span.
  [[nodiscard]] std::size_t IntervalAt(double t) const;
  // Both on the samples' clock.
  [[nodiscard]] bool CoversSampleTimes(double low, double high) const;
  [[nodiscard]] std::optional<Eigen::Quaterniond> WorldFromCamera(double t) const;

  std::vector<double> times_s_;
  std::vector<Eigen::Quaterniond> world_from_camera_;
  std::vector<TimeSpan> gaps_;
  double offset_s_ = 0.0;
  double intervals_per_s_ = 0.0;  // mean density of samples, to guess the index of a time
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_ORIENTATION_TRACK_H_
