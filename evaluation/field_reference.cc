// SPDX-License-Identifier: Apache-2.0
#include "evaluation/field_reference.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "igf/base/homography.h"
#include "igf/base/rotation.h"

namespace rsstab::evaluation {
namespace {

constexpr int kPlaces = 33;      // along the row
constexpr int kFixedPoints = 8;  // a field changes by a tenth of a pixel a row at most
constexpr int kSteps = 6;

// Where the recorded pixel belongs in the view that the field refers to: x + G(x) = recorded.
Eigen::Vector2d SourceOf(const MotionField& field, const Eigen::Vector2d& recorded) {
  Eigen::Vector2d x = recorded;
  for (int i = 0; i < kFixedPoints; ++i) {
    x = recorded - field.Sample(x);
  }
  return x;
}

// old view <- new view: the rotation that takes the recorded row to where the field has it.
Eigen::Matrix3d OldFromNew(const MotionField& field, const Camera& camera, double row) {
  const Eigen::Matrix3d k = camera.K();
  const Eigen::Matrix3d k_inverse = k.inverse();
  Eigen::Matrix3d homography = Eigen::Matrix3d::Identity();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (int i = 0; i < kPlaces; ++i) {
      const Eigen::Vector2d pixel((i + 0.5) / kPlaces * camera.width - 0.5, row);
      const Eigen::Vector2d residual = SourceOf(field, pixel) - Project(homography, pixel);
      // d pi(K exp(w) r) / dw = -d pi(K r) [r]x
      const Eigen::Vector3d ray = rotation * (k_inverse * pixel.homogeneous());
      Eigen::Matrix<double, 2, 3> project;
      project << camera.fx / ray.z(), 0.0, -camera.fx * ray.x() / (ray.z() * ray.z()), 0.0,
          camera.fy / ray.z(), -camera.fy * ray.y() / (ray.z() * ray.z());
      Eigen::Matrix3d cross;
      cross << 0.0, -ray.z(), ray.y(), ray.z(), 0.0, -ray.x(), -ray.y(), ray.x(), 0.0;
      const Eigen::Matrix<double, 2, 3> jacobian = -project * cross;
      normal += jacobian.transpose() * jacobian;
      gradient += jacobian.transpose() * residual;
    }
    rotation = ExpSo3(Eigen::Vector3d(normal.ldlt().solve(gradient))) * rotation;
    homography = k * rotation.toRotationMatrix() * k_inverse;
  }
  return homography;
}

}  // namespace

Result<MotionField> FieldFromRow(const Camera& camera,
                                 std::span<const Eigen::Quaterniond> camera_row_from_any,
                                 double reference_row, const FieldGrid& grid) {
  std::vector<Eigen::Quaterniond> rotations(camera_row_from_any.begin(), camera_row_from_any.end());
  if (rotations.size() > 1) {
    const auto last = static_cast<double>(rotations.size() - 1);
    const double place =
        std::clamp(reference_row / std::max(camera.height - 1.0, 1.0), 0.0, 1.0) * last;
    const auto below = static_cast<std::size_t>(std::min(std::floor(place), last - 1.0));
    const Eigen::Quaterniond reference =
        rotations[below].slerp(place - static_cast<double>(below), rotations[below + 1]);
    for (Eigen::Quaterniond& rotation : rotations) {
      rotation = rotation * reference.conjugate();
    }
  }
  const auto motion = ReadoutMotion::Create(camera, rotations);
  if (!motion) {
    return Propagate(motion.error());
  }
  auto field = ComputeReadoutField(camera, *motion, grid);
  if (field) {
    field->set_reference_row(reference_row);
  }
  return field;
}

Result<MotionField> WithReferenceRow(const MotionField& field, const Camera& camera,
                                     double reference_row) {
  if (camera.width != field.width() || camera.height != field.height()) {
    return Fail(ErrorCode::kInvalidArgument, "a camera of {}x{} does not fit a field of {}x{}",
                camera.width, camera.height, field.width(), field.height());
  }
  if (std::abs(reference_row - field.reference_row()) < kSameRow) {
    return field;
  }
  const Eigen::Matrix3d old_from_new = OldFromNew(field, camera, reference_row);
  MotionField moved = field;
  moved.set_reference_row(reference_row);
  for (int row = 0; row < field.rows(); ++row) {
    for (int column = 0; column < field.columns(); ++column) {
      const Eigen::Vector2d pixel = field.VertexPosition(column, row);
      const Eigen::Vector2d old = Project(old_from_new, pixel);
      moved.At(column, row) = (old + field.Sample(old) - pixel).cast<float>();
    }
  }
  return moved;
}

}  // namespace rsstab::evaluation
