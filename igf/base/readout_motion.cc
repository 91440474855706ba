// SPDX-License-Identifier: Apache-2.0
#include "igf/base/readout_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rsstab {
namespace {

constexpr int kMostKnots = 257;
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

// `map` at the pixel, or its displacement at the nearest pixel towards the principal point where
// `map` is defined.
Eigen::Vector2d DisplacementNear(const Camera& camera, const Eigen::Vector2d& pixel,
                                 const PixelMap& map) {
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

}  // namespace

ReadoutMotion::ReadoutMotion(const Camera& camera)
    : lens_(camera),
      is_pinhole_(camera.model == LensModel::kPinhole),
      last_row_(camera.height - 1.0) {}

int ReadoutMotion::KnotCount(int height) { return std::clamp(height, 2, kMostKnots); }

Result<ReadoutMotion> ReadoutMotion::Create(
    const Camera& camera, std::span<const Eigen::Quaterniond> camera_row_from_reference) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "readout motion");
  }
  if (camera_row_from_reference.size() < 2) {
    return Fail(ErrorCode::kInvalidArgument,
                "a readout motion of {} row rotations needs at least 2",
                camera_row_from_reference.size());
  }
  ReadoutMotion motion(camera);
  const Eigen::Matrix3d k = camera.K();
  const Eigen::Matrix3d k_inverse = k.inverse();
  motion.row_from_ref_.reserve(camera_row_from_reference.size());
  for (const Eigen::Quaterniond& row_from_reference : camera_row_from_reference) {
    if (!row_from_reference.coeffs().allFinite()) {
      return Fail(ErrorCode::kInvalidArgument, "row rotation {} is not finite",
                  motion.row_from_ref_.size());
    }
    const Eigen::Matrix3d rotation = row_from_reference.toRotationMatrix();
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

Result<MotionField> MakeField(const Camera& camera, const FieldGrid& grid) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "motion field");
  }
  if (grid.columns < 2 || grid.rows < 2) {
    return Fail(ErrorCode::kInvalidArgument, "a motion field of {}x{} vertices needs at least 2x2",
                grid.columns, grid.rows);
  }
  return MotionField(camera.width, camera.height, grid.columns, grid.rows);
}

void FillField(const Camera& camera, const PixelMap& map, MotionField& field) {
  for (int row = 0; row < field.rows(); ++row) {
    for (int column = 0; column < field.columns(); ++column) {
      field.At(column, row) =
          DisplacementNear(camera, field.VertexPosition(column, row), map).cast<float>();
    }
  }
}

Result<MotionField> ComputeReadoutField(const Camera& camera, const ReadoutMotion& motion,
                                        const FieldGrid& grid) {
  auto field = MakeField(camera, grid);
  if (field) {
    FillField(
        camera, [&](const Eigen::Vector2d& gs) { return motion.RsFromGs(gs); }, *field);
  }
  return field;
}

}  // namespace rsstab
