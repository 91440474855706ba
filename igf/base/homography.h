// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_HOMOGRAPHY_H_
#define RSSTAB_IGF_BASE_HOMOGRAPHY_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

namespace rsstab {

// Applies `target_from_source` to a pixel. Caller guarantees that the point lies on the near side
// of the horizon (a positive third coordinate); see ProjectChecked otherwise.
[[nodiscard]] inline Eigen::Vector2d Project(const Eigen::Matrix3d& target_from_source,
                                             const Eigen::Vector2d& point) {
  return (target_from_source * point.homogeneous()).hnormalized();
}

// As Project, but empty when the point maps to infinity or behind the camera.
[[nodiscard]] std::optional<Eigen::Vector2d> ProjectChecked(
    const Eigen::Matrix3d& target_from_source, const Eigen::Vector2d& point);

// Inverse with h33 scaled to 1; empty when the matrix is singular, not finite, or flips the image.
[[nodiscard]] std::optional<Eigen::Matrix3d> InvertChecked(const Eigen::Matrix3d& homography);

// The homography that takes source[i] to target[i] exactly (h33 = 1); empty when three of the
// points are collinear.
[[nodiscard]] std::optional<Eigen::Matrix3d> HomographyFromFourPoints(
    const std::array<Eigen::Vector2d, 4>& source, const std::array<Eigen::Vector2d, 4>& target);

// States the same map in the pixels of another image size. Pixel centres are at integers, so a size
// change scales (x + 0.5).
[[nodiscard]] Eigen::Matrix3d RescaleHomography(const Eigen::Matrix3d& homography, int from_width,
                                                int from_height, int to_width, int to_height);

// Smaller over larger singular value of the upper-left 2x2 of `h / h33`, in (0, 1]: the distortion
// value of Liu et al. 2013, section 5 (1 = no anisotropic stretch or shear).
[[nodiscard]] double AffineAnisotropy(const Eigen::Matrix3d& homography);

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_HOMOGRAPHY_H_
