// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_log.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace rsstab::igf {
namespace {

Status CheckOptions(const GyroLogOptions& options) {
  if (options.min_samples < 2) {
    return Fail(ErrorCode::kInvalidArgument, "gyro log: min_samples is {}, must be at least 2",
                options.min_samples);
  }
  if (!(options.max_rate_rad_s > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument, "gyro log: max_rate_rad_s is {}, must be positive",
                options.max_rate_rad_s);
  }
  if (!(options.min_sampling_hz > 0.0 && options.max_sampling_hz > options.min_sampling_hz)) {
    return Fail(ErrorCode::kInvalidArgument,
                "gyro log: sampling limits {} to {} Hz are not a range of positive numbers",
                options.min_sampling_hz, options.max_sampling_hz);
  }
  if (!(options.gap_intervals > 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "gyro log: gap_intervals is {}, must be above 1",
                options.gap_intervals);
  }
  if (!(options.max_missing_ratio >= 0.0 && options.max_missing_ratio <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "gyro log: max_missing_ratio is {}, must be in [0, 1]",
                options.max_missing_ratio);
  }
  return {};
}

Status CheckSamples(std::span<const GyroSample> samples, const GyroLogOptions& options) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const GyroSample& sample = samples[i];
    if (!std::isfinite(sample.time_s)) {
      return Fail(ErrorCode::kCorruptData, "gyro sample {}: the time is not a finite number", i);
    }
    if (!sample.rate_rad_s.allFinite()) {
      return Fail(ErrorCode::kCorruptData,
                  "gyro sample {} at {:.6f} s: an angular rate is not a finite number", i,
                  sample.time_s);
    }
    if (sample.rate_rad_s.cwiseAbs().maxCoeff() > options.max_rate_rad_s) {
      return Fail(ErrorCode::kCorruptData,
                  "gyro sample {} at {:.6f} s: {:.1f} rad/s is faster than any camera turns (limit "
                  "{:.0f}); the log may be in degrees per second",
                  i, sample.time_s, sample.rate_rad_s.cwiseAbs().maxCoeff(),
                  options.max_rate_rad_s);
    }
    if (i > 0 && sample.time_s <= samples[i - 1].time_s) {
      return Fail(
          ErrorCode::kCorruptData,
          "gyro sample {}: time {} from {:.6f} s to {:.6f} s; samples must be in time order", i,
          sample.time_s == samples[i - 1].time_s ? "repeats" : "runs backwards",
          samples[i - 1].time_s, sample.time_s);
    }
  }
  return {};
}

double MedianInterval(std::span<const GyroSample> samples) {
  std::vector<double> intervals(samples.size() - 1);
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    intervals[i] = samples[i + 1].time_s - samples[i].time_s;
  }
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

}  // namespace

Result<GyroLog> GyroLog::Create(std::vector<GyroSample> samples, const GyroLogOptions& options) {
  if (Status status = CheckOptions(options); !status) {
    return Propagate(std::move(status).error());
  }
  if (samples.size() < options.min_samples) {
    return Fail(ErrorCode::kCorruptData,
                "the gyro log has {} samples, at least {} are needed to tell a motion",
                samples.size(), options.min_samples);
  }
  if (Status status = CheckSamples(samples, options); !status) {
    return Propagate(std::move(status).error());
  }

  const double median_s = MedianInterval(samples);
  const double rate_hz = 1.0 / median_s;
  if (!(rate_hz >= options.min_sampling_hz && rate_hz <= options.max_sampling_hz)) {
    return Fail(ErrorCode::kCorruptData,
                "the gyro log has one sample every {:.6g} s ({:.4g} Hz), outside {:g} to {:g} Hz; "
                "is its time column in seconds?",
                median_s, rate_hz, options.min_sampling_hz, options.max_sampling_hz);
  }

  GyroLog log;
  double missing_s = 0.0;
  GyroGap longest;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const GyroGap interval{samples[i - 1].time_s, samples[i].time_s};
    const double length_s = interval.end_s - interval.begin_s;
    if (length_s <= options.gap_intervals * median_s) {
      continue;
    }
    log.gaps_.push_back(interval);
    missing_s += length_s;
    if (length_s > longest.end_s - longest.begin_s) {
      longest = interval;
    }
  }
  const double span_s = samples.back().time_s - samples.front().time_s;
  if (missing_s > options.max_missing_ratio * span_s) {
    return Fail(ErrorCode::kCorruptData,
                "{} gaps take {:.3f} s of the gyro log's {:.3f} s, the longest {:.3f} s at {:.3f} "
                "s; too little is left to trust",
                log.gaps_.size(), missing_s, span_s, longest.end_s - longest.begin_s,
                longest.begin_s);
  }
  // A log that is all gaps cannot arise: the median interval is never one.
  log.mean_rate_hz_ =
      static_cast<double>(samples.size() - 1 - log.gaps_.size()) / (span_s - missing_s);
  log.samples_ = std::move(samples);
  return log;
}

bool GyroLog::Covers(double begin_s, double end_s) const {
  if (!(begin_s >= start_s() && end_s <= this->end_s() && begin_s <= end_s)) {
    return false;
  }
  return std::none_of(gaps_.begin(), gaps_.end(), [&](const GyroGap& gap) {
    return begin_s < gap.end_s && end_s > gap.begin_s;
  });
}

}  // namespace rsstab::igf
