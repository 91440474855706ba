// SPDX-License-Identifier: Apache-2.0
#include "igf/gyro_motion_source.h"

#include <cmath>
#include <utility>

namespace rsstab::igf {

Result<GyroMotionSource> GyroMotionSource::Create(Camera camera, double readout_s,
                                                  OrientationTrack track, const FieldGrid& grid) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "gyro motion source");
  }
  if (!(std::abs(readout_s) <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "readout time {} s must lie within -1 and 1",
                readout_s);
  }
  if (grid.columns < 2 || grid.rows < 2) {
    return Fail(ErrorCode::kInvalidArgument, "a motion field of {}x{} vertices needs at least 2x2",
                grid.columns, grid.rows);
  }
  return GyroMotionSource(std::move(camera), readout_s, std::move(track), grid);
}

GyroMotionSource::GyroMotionSource(Camera camera, double readout_s, OrientationTrack track,
                                   const FieldGrid& grid)
    : camera_(std::move(camera)), readout_s_(readout_s), track_(std::move(track)), grid_(grid) {}

Result<RsMotion> GyroMotionSource::EstimateMotion(const FrameContext& frame) {
  auto field = ComputeIntraGyroField(camera_, track_, frame.time_s, readout_s_, grid_);
  if (!field) {
    return Propagate(field.error(), fmt::format("frame {}", frame.index));
  }
  return RsMotion{std::move(*field), 0.0};
}

std::optional<Eigen::Quaterniond> GyroMotionSource::CameraFromWorld(double time_s) const {
  return track_.CameraFromWorld(time_s);
}

std::optional<Eigen::Quaterniond> GyroMotionSource::TurnBetween(double from_s, double to_s) const {
  return track_.Covers(from_s, to_s) ? RsMotionSource::TurnBetween(from_s, to_s) : std::nullopt;
}

}  // namespace rsstab::igf
