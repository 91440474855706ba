// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/rotation_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "igf/base/rotation.h"

namespace rsstab::rsdiff {
namespace {

double BandCentre(int band, int bands, int height) { return (band + 0.5) / bands * height - 0.5; }

Eigen::Quaterniond RotationOf(const Eigen::Vector3d& value, const Camera& camera) {
  return ExpSo3(Eigen::Vector3d(-value.y() * camera.height / camera.fy,
                                value.x() * camera.height / camera.fx, value.z()));
}

}  // namespace

Eigen::Vector3d CurveAtRow(const RotationCurve& curve, double row, int height) {
  const int bands = static_cast<int>(curve.size());
  if (bands == 1) {
    return curve.front();
  }
  const auto value = [&](int band) -> const Eigen::Vector3d& {
    return curve[static_cast<std::size_t>(band)];
  };
  const auto tangent = [&](int band) -> Eigen::Vector3d {
    if (band == 0) {
      return value(1) - value(0);
    }
    if (band == bands - 1) {
      return value(bands - 1) - value(bands - 2);
    }
    return 0.5 * (value(band + 1) - value(band - 1));
  };
  const double position = (row + 0.5) / height * bands - 0.5;  // in bands; 0 = first centre
  if (position <= 0.0) {
    return value(0) + position * tangent(0);
  }
  if (position >= bands - 1) {
    return value(bands - 1) + (position - (bands - 1)) * tangent(bands - 1);
  }
  const int below = static_cast<int>(position);
  const double u = position - below;
  const double u2 = u * u;
  const double u3 = u2 * u;
  return (2.0 * u3 - 3.0 * u2 + 1.0) * value(below) + (u3 - 2.0 * u2 + u) * tangent(below) +
         (3.0 * u2 - 2.0 * u3) * value(below + 1) + (u3 - u2) * tangent(below + 1);
}

std::vector<Eigen::Quaterniond> RowRotationsFromCurve(const RotationCurve& curve,
                                                      const Camera& camera, int count) {
  const Eigen::Vector3d middle = CurveAtRow(curve, (camera.height - 1) / 2.0, camera.height);
  std::vector<Eigen::Quaterniond> rotations;
  rotations.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double row = (camera.height - 1.0) * i / (count - 1);
    rotations.push_back(RotationOf(CurveAtRow(curve, row, camera.height) - middle, camera));
  }
  return rotations;
}

RotationCurve CurveFromRowRotations(
    const std::function<Eigen::Quaterniond(double row)>& camera_row_from_reference,
    const Camera& camera, int bands) {
  RotationCurve curve;
  for (int band = 0; band < bands; ++band) {
    const double row = std::clamp(BandCentre(band, bands, camera.height), 0.0, camera.height - 1.0);
    const Eigen::Vector3d w = LogSo3(camera_row_from_reference(row));
    curve.emplace_back(w.y() * camera.fx / camera.height, -w.x() * camera.fy / camera.height,
                       w.z());
  }
  return curve;
}

Result<MotionField> FieldFromCurve(const RotationCurve& curve, const Camera& camera,
                                   const FieldGrid& grid) {
  if (const Status valid = camera.Validate(); !valid) {
    return Propagate(valid.error(), "rotation curve");
  }
  if (curve.empty() || !std::all_of(curve.begin(), curve.end(),
                                    [](const Eigen::Vector3d& v) { return v.allFinite(); })) {
    return Fail(ErrorCode::kInvalidArgument,
                "a rotation curve of {} bands must have one at least and finite numbers only",
                curve.size());
  }
  const auto motion = ReadoutMotion::Create(
      camera, RowRotationsFromCurve(curve, camera, ReadoutMotion::KnotCount(camera.height)));
  if (!motion) {
    return Propagate(motion.error());
  }
  return ComputeReadoutField(camera, *motion, grid);
}

RotationCurve CurveFromState(std::span<const float> state, const Eigen::Vector3d& scale) {
  const std::size_t bands = state.size() / 3;
  RotationCurve curve(bands);
  for (std::size_t band = 0; band < bands; ++band) {
    curve[band] = scale.cwiseProduct(
        Eigen::Vector3d(state[band], state[bands + band], state[2 * bands + band]));
  }
  return curve;
}

std::vector<float> StateFromCurve(const RotationCurve& curve, const Eigen::Vector3d& scale) {
  const std::size_t bands = curve.size();
  std::vector<float> state(3 * bands);
  for (std::size_t band = 0; band < bands; ++band) {
    for (int c = 0; c < 3; ++c) {
      state[static_cast<std::size_t>(c) * bands + band] =
          static_cast<float>(curve[band][c] / scale[c]);
    }
  }
  return state;
}

}  // namespace rsstab::rsdiff
