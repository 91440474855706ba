// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_SUPPORT_SKEW_MODEL_H_
#define RSSTAB_TESTS_SUPPORT_SKEW_MODEL_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>

#include "tests/support/test_paths.h"

namespace rsstab::testing {

// A diffusion model (tests/support/models/make_skew_model.py) that answers every picture with the
// same motion: the rotation grows evenly from row to row.
[[nodiscard]] inline std::filesystem::path SkewModel() {
  return SourceFile("tests/support/models/skew");
}

// Where that motion puts a recorded pixel of a picture whose focal length is `focal_px`: in the
// picture of the middle row's instant. Written from the definition of a rotation curve
// (rsdiff/rotation_curve.h), apart from the code under test.
[[nodiscard]] inline Eigen::Vector2d UnskewedFromRecorded(const Eigen::Vector2d& recorded,
                                                          int width, int height, double focal_px) {
  const Eigen::Vector3d per_height(-0.06, 0.02, 0.05);  // (a, b, r), as in make_skew_model.py
  const Eigen::Vector3d curve = per_height * ((recorded.y() + 0.5) / height - 0.5);
  const Eigen::Vector3d turn(-curve.y() * height / focal_px, curve.x() * height / focal_px,
                             curve.z());
  const Eigen::Vector2d centre((width - 1) / 2.0, (height - 1) / 2.0);
  Eigen::Vector3d ray;
  ray << (recorded - centre) / focal_px, 1.0;
  if (turn.norm() > 0.0) {
    ray = Eigen::AngleAxisd(-turn.norm(), turn.normalized()) * ray;
  }
  return ray.hnormalized() * focal_px + centre;
}

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_SUPPORT_SKEW_MODEL_H_
