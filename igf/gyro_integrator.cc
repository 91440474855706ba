// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_integrator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "igf/base/rotation.h"

namespace rsstab::igf {
namespace {

constexpr std::size_t kHalfStencil = 4;
// A polynomial of degree seven swings between unevenly spaced nodes; beyond this ratio of the
// longest to the shortest interval a straight line is the safer guess.
constexpr double kMaxUnevenness = 2.0;
// A low pass nearer to the sampling rate has too few samples under its kernel.
constexpr double kMinOversampling = 3.0;

// Windowed-sinc low pass (three lobes of Lanczos), zero phase, weights normalised, so that a steady
// rate stays and uneven times are tolerated. `run` has no gap.
std::vector<GyroSample> LowPassed(std::span<const GyroSample> run, double cutoff_hz) {
  constexpr double kLobes = 3.0;
  const auto sinc = [](double x) {
    const double a = std::numbers::pi * x;
    return std::abs(a) < 1e-6 ? 1.0 : std::sin(a) / a;
  };
  // The kernel's zeros lie 1 / (2 cutoff) apart.
  const double reach_s = kLobes / (2.0 * cutoff_hz);
  std::vector<GyroSample> result(run.begin(), run.end());
  std::size_t begin = 0;
  for (GyroSample& sample : result) {
    while (run[begin].time_s <= sample.time_s - reach_s) {
      ++begin;
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0.0;
    for (std::size_t i = begin; i < run.size() && run[i].time_s < sample.time_s + reach_s; ++i) {
      const double x = (run[i].time_s - sample.time_s) * 2.0 * cutoff_hz;
      const double weight = sinc(x) * sinc(x / kLobes);
      sum += weight * run[i].rate_rad_s;
      weights += weight;
    }
    sample.rate_rad_s = sum / weights;
  }
  return result;
}

// LowPassed on every stretch between gaps.
std::vector<GyroSample> LowPassedLog(const GyroLog& log, double cutoff_hz) {
  const std::span<const GyroSample> samples = log.samples();
  std::vector<GyroSample> result;
  result.reserve(samples.size());
  const auto append_until = [&](std::size_t end) {
    const auto run = samples.subspan(result.size(), end - result.size());
    const std::vector<GyroSample> filtered = LowPassed(run, cutoff_hz);
    result.insert(result.end(), filtered.begin(), filtered.end());
  };
  std::size_t next = 0;
  for (const GyroGap& gap : log.gaps()) {
    while (next < samples.size() && samples[next].time_s < gap.end_s) {
      ++next;
    }
    append_until(next);
  }
  append_until(samples.size());
  return result;
}

// Rate at `time_s` between samples i and i + 1.
class RateInterpolator {
 public:
  RateInterpolator(std::span<const GyroSample> samples, std::size_t i)
      : low_(&samples[i]), high_(&samples[i + 1]) {
    if (i + 1 < kHalfStencil || i + kHalfStencil >= samples.size()) {
      return;
    }
    const auto stencil = samples.subspan(i + 1 - kHalfStencil, 2 * kHalfStencil);
    double shortest = stencil[1].time_s - stencil[0].time_s;
    double longest = shortest;
    for (std::size_t k = 2; k < stencil.size(); ++k) {
      const double interval = stencil[k].time_s - stencil[k - 1].time_s;
      shortest = std::min(shortest, interval);
      longest = std::max(longest, interval);
    }
    if (longest <= kMaxUnevenness * shortest) {
      stencil_ = stencil;
    }
  }

  [[nodiscard]] Eigen::Vector3d At(double time_s) const {
    if (stencil_.empty()) {
      const double share = (time_s - low_->time_s) / (high_->time_s - low_->time_s);
      return (1.0 - share) * low_->rate_rad_s + share * high_->rate_rad_s;
    }
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();
    for (std::size_t a = 0; a < stencil_.size(); ++a) {
      double weight = 1.0;
      for (std::size_t b = 0; b < stencil_.size(); ++b) {
        if (b != a) {
          weight *= (time_s - stencil_[b].time_s) / (stencil_[a].time_s - stencil_[b].time_s);
        }
      }
      rate += weight * stencil_[a].rate_rad_s;
    }
    return rate;
  }

 private:
  const GyroSample* low_;
  const GyroSample* high_;
  std::span<const GyroSample> stencil_;  // empty: straight line from low_ to high_
};

}  // namespace

Result<OrientationTrack> IntegrateGyro(const GyroLog& log, const GyroIntegrationOptions& options) {
  if (!(options.max_step_s > 0.0 && options.max_step_s <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "the integration step of {} s must lie above 0 and not above 1",
                options.max_step_s);
  }
  if (!options.bias_rad_s.allFinite()) {
    return Fail(ErrorCode::kInvalidArgument, "the gyro bias must be three finite numbers");
  }
  if (!(options.low_pass_hz >= 0.0) || !std::isfinite(options.low_pass_hz)) {
    return Fail(ErrorCode::kInvalidArgument, "a low pass of {} Hz must be 0 (off) or positive",
                options.low_pass_hz);
  }
  std::span<const GyroSample> samples = log.samples();
  std::vector<GyroSample> filtered;
  if (options.low_pass_hz > 0.0 && log.mean_rate_hz() >= kMinOversampling * options.low_pass_hz) {
    filtered = LowPassedLog(log, options.low_pass_hz);
    samples = filtered;
  }
  std::vector<TimeSpan> gaps;
  for (const GyroGap& gap : log.gaps()) {
    gaps.push_back({gap.begin_s, gap.end_s});
  }

  std::vector<double> times{samples.front().time_s};
  std::vector<Eigen::Quaterniond> world_from_camera{Eigen::Quaterniond::Identity()};
  auto next_gap = gaps.begin();
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double begin = samples[i].time_s;
    const double interval = samples[i + 1].time_s - begin;
    Eigen::Quaterniond q = world_from_camera.back();
    if (next_gap != gaps.end() && next_gap->begin_s == begin) {
      ++next_gap;  // unknown motion: orientations beyond are not comparable, so keep this one
      times.push_back(samples[i + 1].time_s);
      world_from_camera.push_back(q);
      continue;
    }
    const RateInterpolator rate(samples, i);
    // The tolerance keeps a 1 ms log at whole steps in spite of round-off in its times.
    const int steps =
        std::max(1, static_cast<int>(std::ceil(interval / options.max_step_s - 1e-6)));
    const double dt = interval / steps;
    for (int step = 0; step < steps; ++step) {
      const Eigen::Vector3d w = rate.At(begin + (step + 0.5) * dt) - options.bias_rad_s;
      q = (q * ExpSo3(Eigen::Vector3d(w * dt))).normalized();
      times.push_back(step + 1 == steps ? samples[i + 1].time_s : begin + (step + 1) * dt);
      world_from_camera.push_back(q);
    }
  }
  return OrientationTrack::Create(std::move(times), std::move(world_from_camera), std::move(gaps));
}

}  // namespace rsstab::igf
