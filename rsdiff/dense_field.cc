// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/dense_field.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "igf/base/homography.h"
#include "igf/base/rotation.h"

namespace rsstab::rsdiff {
namespace {

constexpr int kMaxRowIterations = 20;
constexpr double kConverged_px = 1e-4;
constexpr int kMaxFitIterations = 20;
constexpr double kConvergedAngle_rad = 1e-10;
// Keeps the roll at zero where an image of a few columns does not show it.
constexpr double kRidge = 1e-9;

// One coordinate of the small picture: the two pixels around it and the share of the second, which
// leaves [0, 1] beyond the outer centres.
struct Between {
  int first;
  double share;
};
Between Locate(double at, int count) {
  const int first = std::clamp(static_cast<int>(std::floor(at)), 0, count - 2);
  return {first, at - first};
}

// The field, straight on beyond the image's edge (where MotionField::Sample stands still).
Eigen::Vector2d SampleStraightOn(const MotionField& field, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d edge =
      pixel.cwiseMax(Eigen::Vector2d::Zero())
          .cwiseMin(Eigen::Vector2d(field.width() - 1, field.height() - 1));
  return 2.0 * field.Sample(edge) - field.Sample(2.0 * edge - pixel);
}

// Where the reference row's own content lies: the x with x + G(x) = `rs_pixel`.
Eigen::Vector2d GsFromRs(const MotionField& field, const Eigen::Vector2d& rs_pixel) {
  Eigen::Vector2d x = rs_pixel;
  for (int i = 0; i < kMaxRowIterations; ++i) {
    const Eigen::Vector2d next = rs_pixel - SampleStraightOn(field, x);
    const bool done = (next - x).norm() < kConverged_px;
    x = next;
    if (done) {
      break;
    }
  }
  return x;
}

// The rotation middle_from_reference that takes each `from` ray closest to its `to` ray (the
// orthogonal Procrustes problem on unit rays).
Eigen::Matrix3d FitRotation(const std::vector<Eigen::Vector3d>& from,
                            const std::vector<Eigen::Vector3d>& to) {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  for (int iteration = 0; iteration < kMaxFitIterations; ++iteration) {
    Eigen::Matrix3d normal = kRidge * Eigen::Matrix3d::Identity();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
      // For a small turn w: R f + w x (R f) = t. Gauss-Newton on the rays.
      const Eigen::Vector3d moved = rotation * from[i];
      normal += Eigen::Matrix3d::Identity() - moved * moved.transpose();
      gradient += moved.cross(to[i] - moved);
    }
    const Eigen::Vector3d step = normal.inverse() * gradient;
    rotation = (ExpSo3(step) * rotation).normalized();
    if (step.norm() < kConvergedAngle_rad) {
      break;
    }
  }
  return rotation.toRotationMatrix();
}

}  // namespace

Result<MotionField> FieldFromDenseState(std::span<const float> state, const Shape& shape, int width,
                                        int height, double reference_row, const FieldGrid& grid) {
  if (shape.channels != 2 || shape.rows < 2 || shape.columns < 2 || state.size() != shape.Count()) {
    return Fail(ErrorCode::kInvalidArgument,
                "a dense field of {} numbers in {}x{}x{} needs 2 channels and at least 2x2 pixels",
                state.size(), shape.channels, shape.rows, shape.columns);
  }
  if (!std::all_of(state.begin(), state.end(), [](float v) { return std::isfinite(v); })) {
    return Fail(ErrorCode::kInvalidArgument, "a dense field must have finite numbers only");
  }
  if (width < 1 || height < 1 || grid.columns < 2 || grid.rows < 2) {
    return Fail(ErrorCode::kInvalidArgument,
                "a motion field of {}x{} vertices on {}x{} pixels needs 2x2 and 1x1 at least",
                grid.columns, grid.rows, width, height);
  }
  const auto value = [&](int channel, int row, int column) {
    return static_cast<double>(state[(static_cast<std::size_t>(channel * shape.rows + row)) *
                                         static_cast<std::size_t>(shape.columns) +
                                     static_cast<std::size_t>(column)]);
  };
  const double sx = static_cast<double>(width) / shape.columns;
  const double sy = static_cast<double>(height) / shape.rows;
  const Eigen::Vector2d unit_px((shape.columns - 1) * sx, (shape.rows - 1) * sy);
  MotionField field(width, height, grid.columns, grid.rows);
  field.set_reference_row(reference_row);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2d vertex = field.VertexPosition(column, row);
      const Between x = Locate((vertex.x() + 0.5) / sx - 0.5, shape.columns);
      const Between y = Locate((vertex.y() + 0.5) / sy - 0.5, shape.rows);
      const auto at = [&](int channel) {
        const double top = (1.0 - x.share) * value(channel, y.first, x.first) +
                           x.share * value(channel, y.first, x.first + 1);
        const double bottom = (1.0 - x.share) * value(channel, y.first + 1, x.first) +
                              x.share * value(channel, y.first + 1, x.first + 1);
        return (1.0 - y.share) * top + y.share * bottom;
      };
      field.At(column, row) = unit_px.cwiseProduct(Eigen::Vector2d(at(0), at(1))).cast<float>();
    }
  }
  return field;
}

std::vector<float> DenseStateFromField(const MotionField& field, const Shape& shape) {
  const double sx = static_cast<double>(field.width()) / shape.columns;
  const double sy = static_cast<double>(field.height()) / shape.rows;
  std::vector<float> state(shape.Count());
  const std::size_t plane = state.size() / 2;
  std::size_t next = 0;
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column, ++next) {
      const Eigen::Vector2d g = field.Sample({(column + 0.5) * sx - 0.5, (row + 0.5) * sy - 0.5});
      state[next] = static_cast<float>(g.x() / (sx * (shape.columns - 1)));
      state[plane + next] = static_cast<float>(g.y() / (sy * (shape.rows - 1)));
    }
  }
  return state;
}

Result<MotionField> WithMiddleReference(const MotionField& field, const Camera& camera) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "motion field");
  }
  if (camera.width != field.width() || camera.height != field.height()) {
    return Fail(ErrorCode::kInvalidArgument,
                "a camera of {}x{} pixels does not fit a motion field of {}x{}", camera.width,
                camera.height, field.width(), field.height());
  }
  const double middle_row = (field.height() - 1) / 2.0;
  const Eigen::Matrix3d k = camera.K();
  const Eigen::Matrix3d k_inverse = k.inverse();
  std::vector<Eigen::Vector3d> reference_rays;
  std::vector<Eigen::Vector3d> middle_rays;
  for (int column = 0; column < field.columns(); ++column) {
    const Eigen::Vector2d rs_pixel(field.VertexPosition(column, 0).x(), middle_row);
    reference_rays.push_back((k_inverse * GsFromRs(field, rs_pixel).homogeneous()).normalized());
    middle_rays.push_back((k_inverse * rs_pixel.homogeneous()).normalized());
  }
  const Eigen::Matrix3d reference_from_middle =
      k * FitRotation(reference_rays, middle_rays).transpose() * k_inverse;
  MotionField result(field.width(), field.height(), field.columns(), field.rows());
  for (int row = 0; row < field.rows(); ++row) {
    for (int column = 0; column < field.columns(); ++column) {
      const Eigen::Vector2d x = field.VertexPosition(column, row);
      const Eigen::Vector2d in_reference = ProjectChecked(reference_from_middle, x).value_or(x);
      result.At(column, row) =
          (in_reference + SampleStraightOn(field, in_reference) - x).cast<float>();
    }
  }
  return result;
}

}  // namespace rsstab::rsdiff
