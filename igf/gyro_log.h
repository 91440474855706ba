// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_GYRO_LOG_H_
#define RSSTAB_IGF_GYRO_LOG_H_

#include <Eigen/Core>
#include <span>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::igf {

// One reading of the gyroscope.
struct GyroSample {
  double time_s = 0.0;  // the log's own clock; t_video = t_gyro + offset
  // Angular velocity, rad/s, right-hand rule, camera axes: x right, y down, z forward. A positive y
  // is a yaw to the right: the picture moves left.
  Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();
};

// A stretch without readings: the samples at begin_s and end_s are there, none lies between.
struct GyroGap {
  double begin_s = 0.0;
  double end_s = 0.0;
};

// What GyroLog::Create refuses. The defaults suit every IMU found in or on a camera.
struct GyroLogOptions {
  std::size_t min_samples = 2;    // at least 2: one interval
  double max_rate_rad_s = 100.0;  // 5730 deg/s; the fastest common sensors end at 4000 deg/s
  double min_sampling_hz = 10.0;  // slower cannot tell the motion inside a frame
  double max_sampling_hz = 50e3;
  double gap_intervals = 10.0;      // an interval longer than this many medians is a gap
  double max_missing_ratio = 0.25;  // share of the log's span, in [0, 1], that gaps may take
};

// A checked log of angular rates: finite, strictly increasing in time, at a plausible rate.
// Immutable, so any thread may read it.
//
// A small gap does not spoil a log. It stays usable where it is whole: gaps() lists the holes, and
// whoever asks for a motion inside one must be refused (see Covers). Integration across a gap is
// meaningless, so orientations on the two sides of one are not comparable.
class GyroLog {
 public:
  // Errors (kInvalidArgument for bad options, kCorruptData otherwise), each naming the sample,
  // counted from 0, and its time: a number that is not finite, time that repeats or runs backwards,
  // a rate beyond the limit, too few samples, an impossible sampling rate, gaps that take more than
  // max_missing_ratio of the log (the longest one is named).
  [[nodiscard]] static Result<GyroLog> Create(std::vector<GyroSample> samples,
                                              const GyroLogOptions& options = {});

  [[nodiscard]] std::span<const GyroSample> samples() const { return samples_; }
  [[nodiscard]] double start_s() const { return samples_.front().time_s; }
  [[nodiscard]] double end_s() const { return samples_.back().time_s; }
  // Samples per second outside gaps.
  [[nodiscard]] double mean_rate_hz() const { return mean_rate_hz_; }
  // In time order, disjoint.
  [[nodiscard]] std::span<const GyroGap> gaps() const { return gaps_; }

  // True when [begin_s, end_s] lies inside the log and touches the inside of no gap.
  [[nodiscard]] bool Covers(double begin_s, double end_s) const;

 private:
  GyroLog() = default;

  std::vector<GyroSample> samples_;
  std::vector<GyroGap> gaps_;
  double mean_rate_hz_ = 0.0;
};

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_GYRO_LOG_H_
