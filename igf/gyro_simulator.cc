// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_simulator.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "igf/base/seeded_random.h"

namespace rsstab::igf {

Result<GyroLog> SimulateGyro(const OrientationTrack& orientation, double begin_s, double end_s,
                             const GyroSimulatorOptions& options) {
  if (!(options.sampling_hz >= 10.0 && options.sampling_hz <= 20000.0)) {
    return Fail(ErrorCode::kInvalidArgument, "A gyro is sampled at 10 to 20000 Hz, not {} Hz.",
                options.sampling_hz);
  }
  if (!std::isfinite(options.offset_s) || !options.bias_rad_s.allFinite() ||
      !(options.noise_rad_s >= 0.0 && std::isfinite(options.noise_rad_s))) {
    return Fail(ErrorCode::kInvalidArgument,
                "The gyro's offset, bias and noise must be finite, the noise not negative.");
  }
  const double dt = 1.0 / options.sampling_hz;
  const double window_s = options.averaging_s;
  // A hair of room for round-off in a caller's 1 / sampling_hz.
  if (!(window_s > 0.0 && window_s <= dt * (1.0 + 1e-9))) {
    return Fail(ErrorCode::kInvalidArgument,
                "A gyro at {} Hz averages each sample over at most {:.6f} s, not {} s.",
                options.sampling_hz, dt, window_s);
  }
  if (!(end_s > begin_s) || !orientation.Covers(begin_s - window_s, end_s + window_s)) {
    return Fail(ErrorCode::kInvalidArgument,
                "A gyro log over {:.4f} to {:.4f} s needs a motion that covers it and a little "
                "more; this one covers {:.4f} to {:.4f} s.",
                begin_s, end_s, orientation.start_s(), orientation.end_s());
  }
  SeededRandom random(options.noise_seed);
  const auto count = static_cast<std::size_t>(std::floor((end_s - begin_s) / dt + 1e-9)) + 1;
  std::vector<GyroSample> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = begin_s + static_cast<double>(i) * dt;
    const std::optional<Eigen::Vector3d> rate =
        orientation.MeanRate(time_s - window_s / 2.0, time_s + window_s / 2.0);
    if (!rate) {
      return Fail(ErrorCode::kInternal, "The motion ends before {:.6f} s.", time_s);
    }
    const Eigen::Vector3d noise(random.Normal(), random.Normal(), random.Normal());
    samples[i].time_s = time_s - options.offset_s;
    samples[i].rate_rad_s = *rate + options.bias_rad_s + options.noise_rad_s * noise;
  }
  return GyroLog::Create(std::move(samples));
}

}  // namespace rsstab::igf
