// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/pipeline/fused_motion_source.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "igf/base/rolling_shutter.h"
#include "stabilizer/track_cells.h"

namespace rsstab::pipeline {

Result<std::unique_ptr<FusedMotionSource>> FusedMotionSource::Create(
    std::string name, const Camera& camera, bool lens_is_known,
    const stabilizer::RsMotionModel& model) {
  if (Status ok = camera.Validate(); !ok) {
    return Propagate(std::move(ok.error()));
  }
  if (!std::isfinite(model.readout_s) || !(model.frame_interval_s > 0.0) || !(model.focal > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "rolling-shutter fusion: a readout of {} s, a frame interval of {} s and a focal "
                "length of {} picture widths are not possible together",
                model.readout_s, model.frame_interval_s, model.focal);
  }
  return std::unique_ptr<FusedMotionSource>(
      new FusedMotionSource(std::move(name), camera, lens_is_known, model));
}

FusedMotionSource::FusedMotionSource(std::string name, const Camera& camera, bool lens_is_known,
                                     const stabilizer::RsMotionModel& model)
    : name_(std::move(name)), camera_(camera), lens_is_known_(lens_is_known), fusion_(model) {
  camera_.readout_s = model.readout_s;
}

void FusedMotionSource::Observe(const PointTracks& tracks, double time_s) {
  times_s_.push_back(time_s);
  fusion_.Push(time_s, stabilizer::SummarizeTracks(tracks, lens_is_known_ ? &camera_ : nullptr));
  TakeDecided();
}

void FusedMotionSource::FinishObserving() {
  fusion_.Finish();
  TakeDecided();
}

std::int64_t FusedMotionSource::NumAnswerable() const {
  return first_decided_ + static_cast<std::int64_t>(decided_.size());
}

void FusedMotionSource::TakeDecided() {
  for (stabilizer::FusedFrame& frame : fusion_.TakeReady()) {
    decided_.push_back({times_s_.front(), std::move(frame)});
    times_s_.pop_front();
  }
}

Result<RsMotion> FusedMotionSource::EstimateMotion(const FrameContext& frame) {
  if (frame.index < first_decided_ || frame.index >= NumAnswerable()) {
    return Fail(ErrorCode::kInvalidArgument,
                "rolling-shutter fusion: frame {} was asked for, frames {} to {} can be answered",
                frame.index, first_decided_, NumAnswerable() - 1);
  }
  // The frame before stays: its orientation is asked for together with this one's.
  while (first_decided_ + 1 < frame.index) {
    decided_.pop_front();
    ++first_decided_;
  }
  asked_for_ = frame.index;
  const stabilizer::FusedFrame& motion =
      decided_[static_cast<std::size_t>(frame.index - first_decided_)].motion;
  const auto unknown = [&] {
    return Fail(ErrorCode::kUntrustworthy, "frame {}: no tracks tell how the camera moved",
                frame.index);
  };
  if (!motion.spline) {
    return unknown();
  }
  const double readout_s = *camera_.readout_s;
  if (readout_s == 0.0) {
    return RsMotion{};  // a global shutter: no field, and nothing to render
  }
  const auto reference = motion.spline->CameraFromWorld(motion.time_s);
  if (!reference) {
    return unknown();
  }
  const int num_rows = ReadoutMotion::KnotCount(camera_.height);
  std::vector<Eigen::Quaterniond> row_from_reference;
  for (int i = 0; i < num_rows; ++i) {
    const double row = static_cast<double>(i) * (camera_.height - 1) / (num_rows - 1);
    const auto at_row = motion.spline->CameraFromWorld(
        RowExposureTime(motion.time_s, row, camera_.height, readout_s));
    if (!at_row) {
      return unknown();
    }
    row_from_reference.push_back(*at_row * reference->conjugate());
  }
  auto readout_motion = ReadoutMotion::Create(camera_, row_from_reference);
  if (!readout_motion) {
    return Propagate(std::move(readout_motion.error()));
  }
  auto field = ComputeReadoutField(camera_, *readout_motion);
  if (!field) {
    return Propagate(std::move(field.error()));
  }
  return RsMotion{std::move(*field), 0.0};
}

std::optional<Eigen::Quaterniond> FusedMotionSource::CameraFromWorld(double time_s) const {
  const std::int64_t present = asked_for_ - first_decided_;
  if (asked_for_ < 0 || present >= static_cast<std::int64_t>(decided_.size())) {
    return std::nullopt;
  }
  const std::int64_t part = decided_[static_cast<std::size_t>(present)].motion.part;
  for (std::int64_t i = present; i >= 0; --i) {
    const Decided& frame = decided_[static_cast<std::size_t>(i)];
    if (frame.frame_time_s == time_s && frame.motion.part == part && frame.motion.spline) {
      return frame.motion.spline->CameraFromWorld(frame.motion.time_s);
    }
  }
  return std::nullopt;
}

}  // namespace rsstab::pipeline
