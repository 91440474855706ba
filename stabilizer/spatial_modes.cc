// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/spatial_modes.h"

#include <cmath>
#include <numbers>

namespace rsstab::stabilizer {
namespace {

// Column k of the orthonormal DCT-II of n samples.
Eigen::VectorXd CosineMode(int n, int k) {
  Eigen::VectorXd mode(n);
  for (int i = 0; i < n; ++i) {
    mode(i) = std::cos(std::numbers::pi * k * (i + 0.5) / n);
  }
  return mode.normalized();
}

double Stiffness(int n, int k) { return 2.0 - 2.0 * std::cos(std::numbers::pi * k / n); }

}  // namespace

SpatialModes::SpatialModes(int columns, int rows, int max_order) {
  const int nx = columns + 1;
  const int ny = rows + 1;
  std::vector<Eigen::VectorXd> modes;
  for (int j = 0; j < ny && j <= max_order; ++j) {
    const Eigen::VectorXd vertical = CosineMode(ny, j);
    for (int i = 0; i < nx && i + j <= max_order; ++i) {
      const Eigen::VectorXd horizontal = CosineMode(nx, i);
      Eigen::VectorXd mode(nx * ny);
      for (int r = 0; r < ny; ++r) {
        mode.segment(static_cast<Eigen::Index>(r) * nx, nx) = vertical(r) * horizontal;
      }
      modes.push_back(std::move(mode));
      stiffness_.push_back(Stiffness(nx, i) + Stiffness(ny, j));
    }
  }
  basis_.resize(static_cast<Eigen::Index>(nx) * ny, static_cast<Eigen::Index>(modes.size()));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    basis_.col(static_cast<Eigen::Index>(k)) = modes[k];
  }
}

std::vector<Eigen::Vector2d> SpatialModes::Analyze(
    std::span<const Eigen::Vector2d> vertices) const {
  std::vector<Eigen::Vector2d> coefficients(count(), Eigen::Vector2d::Zero());
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      coefficients[k] +=
          basis_(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k)) * vertices[v];
    }
  }
  return coefficients;
}

std::vector<Eigen::Vector2d> SpatialModes::Synthesize(
    std::span<const Eigen::Vector2d> coefficients) const {
  std::vector<Eigen::Vector2d> vertices(static_cast<std::size_t>(basis_.rows()),
                                        Eigen::Vector2d::Zero());
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      vertices[v] +=
          basis_(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k)) * coefficients[k];
    }
  }
  return vertices;
}

}  // namespace rsstab::stabilizer
