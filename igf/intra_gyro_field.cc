// SPDX-License-Identifier: Apache-2.0
#include "igf/intra_gyro_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "igf/base/rolling_shutter.h"

namespace rsstab::igf {
namespace {

// Knots of the row table. With 30 ms of readout they are 0.12 ms apart, so that a straight line
// between two rotations is off by less than 0.01 px even at 60 Hz of vibration.
constexpr int kRowKnots = 257;
constexpr int kMaxIterations = 8;
constexpr double kConverged_px = 1e-3;
// Steps towards the principal point when a pixel has no ray.
constexpr double kShrink = 0.97;
constexpr int kMaxShrinks = 60;

// The fixed point p = map(p.y), started at `start`. Plain iteration contracts by the field's change
// per row (0.1 or so for a whip pan); a secant step on the row squares that.
template <typename Map>
std::optional<Eigen::Vector2d> SolveRow(const Map& map, double start_row) {
  double row = start_row;
  auto p = map(row);
  if (!p) {
    return std::nullopt;
  }
  double last_row = row;
  double last_residual = 0.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double residual = p->y() - row;
    if (std::abs(residual) < kConverged_px) {
      break;
    }
    double next = p->y();
    if (i > 0) {
      const double slope = (residual - last_residual) / (row - last_row);
      // A slope near -1 belongs to a contraction; anything else is left to plain iteration.
      if (slope < -0.25) {
        next = row - residual / slope;
      }
    }
    last_row = row;
    last_residual = residual;
    row = next;
    p = map(row);
    if (!p) {
      return std::nullopt;
    }
  }
  return p;
}

Result<MotionField> MakeGrid(const Camera& camera, const FieldGrid& grid) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "motion field");
  }
  if (grid.columns < 2 || grid.rows < 2) {
    return Fail(ErrorCode::kInvalidArgument, "a motion field of {}x{} vertices needs at least 2x2",
                grid.columns, grid.rows);
  }
  return MotionField(camera.width, camera.height, grid.columns, grid.rows);
}

// `map` at the pixel, or its displacement at the nearest pixel towards the principal point where
// `map` is defined.
template <typename Map>
Eigen::Vector2d DisplacementNear(const Camera& camera, const Eigen::Vector2d& pixel,
                                 const Map& map) {
  const Eigen::Vector2d centre(camera.cx, camera.cy);
  Eigen::Vector2d at = pixel;
  for (int i = 0; i < kMaxShrinks; ++i) {
    if (const auto mapped = map(at)) {
      return *mapped - at;
    }
    at = centre + kShrink * (at - centre);
  }
  return Eigen::Vector2d::Zero();
}

template <typename Map>
void FillField(const Camera& camera, const Map& map, MotionField& field) {
  for (int row = 0; row < field.rows(); ++row) {
    for (int column = 0; column < field.columns(); ++column) {
      field.At(column, row) =
          DisplacementNear(camera, field.VertexPosition(column, row), map).template cast<float>();
    }
  }
}

}  // namespace

ReadoutMotion::ReadoutMotion(const Camera& camera)
    : lens_(camera),
      is_pinhole_(camera.model == LensModel::kPinhole),
      last_row_(camera.height - 1.0) {}

Result<ReadoutMotion> ReadoutMotion::Create(const Camera& camera, const OrientationTrack& track,
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
  ReadoutMotion motion(camera);
  if (readout_s == 0.0) {
    motion.row_from_ref_.assign(2, Eigen::Matrix3d::Identity());
    return motion;
  }
  const auto time_of = [&](double row) {
    return RowExposureTime(frame_time_s, row, camera.height, readout_s);
  };
  const double reference_s = time_of(reference_row);
  const auto [begin_s, end_s] = std::minmax({time_of(0.0), time_of(motion.last_row_), reference_s});
  if (!track.Covers(begin_s, end_s)) {
    return Fail(ErrorCode::kUntrustworthy,
                "the frame at {:.3f} s was read out from {:.4f} s to {:.4f} s, but the orientation "
                "is known only from {:.3f} s to {:.3f} s (or has a gap there)",
                frame_time_s, begin_s, end_s, track.start_s(), track.end_s());
  }
  const Eigen::Quaterniond world_from_ref = track.CameraFromWorld(reference_s)->conjugate();
  const Eigen::Matrix3d k = camera.K();
  const Eigen::Matrix3d k_inverse = k.inverse();
  const int knots = std::clamp(camera.height, 2, kRowKnots);
  motion.row_from_ref_.reserve(static_cast<std::size_t>(knots));
  for (int i = 0; i < knots; ++i) {
    const double row = motion.last_row_ * i / (knots - 1);
    const Eigen::Matrix3d rotation =
        (*track.CameraFromWorld(time_of(row)) * world_from_ref).toRotationMatrix();
    motion.row_from_ref_.push_back(motion.is_pinhole_ ? Eigen::Matrix3d(k * rotation * k_inverse)
                                                      : rotation);
  }
  return motion;
}

Eigen::Matrix3d ReadoutMotion::AtRow(double row) const {
  const auto last = static_cast<double>(row_from_ref_.size() - 1);
  // Written so that NaN (a diverged fixed point) reads the first row.
  const double position = row > 0.0 ? std::min(row / last_row_, 1.0) * last : 0.0;
  const auto below = static_cast<std::size_t>(std::min(std::floor(position), last - 1.0));
  const double share = position - static_cast<double>(below);
  return (1.0 - share) * row_from_ref_[below] + share * row_from_ref_[below + 1];
}

std::optional<Eigen::Vector2d> ReadoutMotion::RsFromGs(const Eigen::Vector2d& gs_pixel) const {
  if (is_pinhole_) {
    const Eigen::Vector3d point = gs_pixel.homogeneous();
    return SolveRow(
        [&](double row) -> std::optional<Eigen::Vector2d> {
          const Eigen::Vector3d moved = AtRow(row) * point;
          if (!(moved.z() > 0.0)) {
            return std::nullopt;
          }
          return moved.hnormalized();
        },
        gs_pixel.y());
  }
  const auto ray = lens_.UnprojectPixel(gs_pixel);
  if (!ray) {
    return std::nullopt;
  }
  return SolveRow([&](double row) { return lens_.ProjectRay(AtRow(row) * *ray); }, gs_pixel.y());
}

std::optional<Eigen::Vector2d> ReadoutMotion::GsFromRs(const Eigen::Vector2d& rs_pixel) const {
  const Eigen::Matrix3d row_from_ref = AtRow(rs_pixel.y());
  if (is_pinhole_) {
    const Eigen::Vector3d moved = row_from_ref.inverse() * rs_pixel.homogeneous();
    if (!(moved.z() > 0.0)) {
      return std::nullopt;
    }
    return moved.hnormalized();
  }
  const auto ray = lens_.UnprojectPixel(rs_pixel);
  if (!ray) {
    return std::nullopt;
  }
  return lens_.ProjectRay(row_from_ref.inverse() * *ray);
}

Result<MotionField> ComputeIntraGyroField(const Camera& camera, const OrientationTrack& track,
                                          double frame_time_s, double readout_s,
                                          const FieldGrid& grid) {
  auto field = MakeGrid(camera, grid);
  if (!field) {
    return field;
  }
  const auto motion =
      ReadoutMotion::Create(camera, track, frame_time_s, readout_s, field->reference_row());
  if (!motion) {
    return Propagate(motion.error());
  }
  FillField(
      camera, [&](const Eigen::Vector2d& gs) { return motion->RsFromGs(gs); }, *field);
  return field;
}

Result<MotionField> ComputeBandField(const Camera& camera, const OrientationTrack& track,
                                     double frame_time_s, double readout_s,
                                     const BandFieldOptions& options) {
  auto field = MakeGrid(camera, options.grid);
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
