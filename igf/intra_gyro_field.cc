// SPDX-License-Identifier: Apache-2.0
#include "igf/intra_gyro_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "igf/base/rolling_shutter.h"

namespace rsstab::igf {

Result<ReadoutMotion> ComputeReadoutMotion(const Camera& camera, const OrientationTrack& track,
                                           double frame_time_s, double readout_s,
                                           double reference_row) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "readout motion");
  }
  if (!std::isfinite(frame_time_s) || !std::isfinite(readout_s) || !std::isfinite(reference_row)) {
    return Fail(ErrorCode::kInvalidArgument,
                "frame time {} s, readout {} s and reference row {} must be finite", frame_time_s,
                readout_s, reference_row);
  }
  std::vector<Eigen::Quaterniond> row_from_ref;
  if (readout_s == 0.0) {
    row_from_ref.assign(2, Eigen::Quaterniond::Identity());
    return ReadoutMotion::Create(camera, row_from_ref);
  }
  const auto time_of = [&](double row) {
    return RowExposureTime(frame_time_s, row, camera.height, readout_s);
  };
  const double last_row = camera.height - 1.0;
  const double reference_s = time_of(reference_row);
  const auto [begin_s, end_s] = std::minmax({time_of(0.0), time_of(last_row), reference_s});
  if (!track.Covers(begin_s, end_s)) {
    return Fail(ErrorCode::kUntrustworthy,
                "the frame at {:.3f} s was read out from {:.4f} s to {:.4f} s, but the orientation "
                "is known only from {:.3f} s to {:.3f} s (or has a gap there)",
                frame_time_s, begin_s, end_s, track.start_s(), track.end_s());
  }
  const Eigen::Quaterniond world_from_ref = track.CameraFromWorld(reference_s)->conjugate();
  const int knots = ReadoutMotion::KnotCount(camera.height);
  row_from_ref.reserve(static_cast<std::size_t>(knots));
  for (int i = 0; i < knots; ++i) {
    const double row = last_row * i / (knots - 1);
    row_from_ref.push_back(*track.CameraFromWorld(time_of(row)) * world_from_ref);
  }
  return ReadoutMotion::Create(camera, row_from_ref);
}

Result<MotionField> ComputeIntraGyroField(const Camera& camera, const OrientationTrack& track,
                                          double frame_time_s, double readout_s,
                                          const FieldGrid& grid) {
  const auto motion =
      ComputeReadoutMotion(camera, track, frame_time_s, readout_s, (camera.height - 1) / 2.0);
  if (!motion) {
    return Propagate(motion.error());
  }
  return ComputeReadoutField(camera, *motion, grid);
}

Result<MotionField> ComputeBandField(const Camera& camera, const OrientationTrack& track,
                                     double frame_time_s, double readout_s,
                                     const BandFieldOptions& options) {
  auto field = MakeField(camera, options.grid);
  if (!field) {
    return field;
  }
  if (options.bands < 1 || options.bands > camera.height || options.reference_band < 0 ||
      options.reference_band >= options.bands) {
    return Fail(ErrorCode::kInvalidArgument,
                "{} bands relative to band {} do not fit an image of {} rows", options.bands,
                options.reference_band, camera.height);
  }
  const double band_rows = static_cast<double>(camera.height) / options.bands;
  const auto middle_row = [&](int band) { return (band + 0.5) * band_rows - 0.5; };
  field->set_reference_row(middle_row(options.reference_band));
  if (readout_s == 0.0) {
    return field;
  }
  const auto time_of = [&](int band) {
    return RowExposureTime(frame_time_s, middle_row(band), camera.height, readout_s);
  };
  if (!track.Covers(time_of(0), time_of(options.bands - 1))) {
    return Fail(ErrorCode::kUntrustworthy,
                "the frame at {:.3f} s with {:.4f} s of readout is not covered by the orientation, "
                "known from {:.3f} s to {:.3f} s (or it has a gap there)",
                frame_time_s, readout_s, track.start_s(), track.end_s());
  }
  const Eigen::Quaterniond world_from_ref =
      track.CameraFromWorld(time_of(options.reference_band))->conjugate();
  std::vector<Eigen::Matrix3d> band_from_ref;
  for (int band = 0; band < options.bands; ++band) {
    band_from_ref.push_back(
        (*track.CameraFromWorld(time_of(band)) * world_from_ref).toRotationMatrix());
  }
  const CameraProjector lens(camera);
  FillField(
      camera,
      [&](const Eigen::Vector2d& gs) -> std::optional<Eigen::Vector2d> {
        const auto ray = lens.UnprojectPixel(gs);
        if (!ray) {
          return std::nullopt;
        }
        const int band = std::clamp(static_cast<int>(std::floor((gs.y() + 0.5) / band_rows)), 0,
                                    options.bands - 1);
        return lens.ProjectRay(band_from_ref[static_cast<std::size_t>(band)] * *ray);
      },
      *field);
  return field;
}

}  // namespace rsstab::igf
