// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "igf/base/rotation.h"
#include "stabilizer/update_parameters_detail.h"

namespace rsstab::stabilizer {

Eigen::Matrix3d UpdateHomography(const UpdateParameters& theta, double focal_ratio) {
  const Eigen::Vector3d k(focal_ratio, focal_ratio, 1.0);
  const Eigen::Matrix3d turn =
      ExpSo3(Eigen::Vector3d(theta[0], theta[1], theta[2])).toRotationMatrix();
  const double zoom = std::exp(theta[5]);
  Eigen::Matrix3d affine;
  affine << zoom * (1.0 + theta[6]), theta[7], theta[3],  //
      theta[7], zoom * (1.0 - theta[6]), theta[4],        //
      0.0, 0.0, 1.0;
  const Eigen::Matrix3d update = k.asDiagonal() * turn * k.cwiseInverse().asDiagonal() * affine;
  return update / update(2, 2);
}

}  // namespace rsstab::stabilizer
