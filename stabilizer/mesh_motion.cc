// SPDX-License-Identifier: Apache-2.0
#include "stabilizer/mesh_motion.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>

#include "igf/base/homography.h"
#include "stabilizer/normalized_coordinates.h"

namespace rsstab::stabilizer {
namespace {

using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr double kPx = 1.0 / kReferenceWidthPx;
constexpr std::size_t kMinMatches = 12;
// Neighbouring frames of a real scene seldom differ by more parallax than this; what does is an
// object that moves by itself, and the camera path must not follow it.
constexpr double kMaxLocalMotion = 4.0 * kPx;
// Sub-frames for the local vote, and how far a match may stand from its sub-frame's median.
constexpr std::size_t kSubFrames = 4;
constexpr double kLocalTolerance = 3.0;           // median absolute deviations
constexpr double kMinLocalTolerance = 0.6 * kPx;  // tracking noise and a slope inside the sub-frame
// alpha = kShapeWeight (1 + kUnsupportedBoost / (1 + n)) for a cell with n matches: an empty cell
// follows its neighbours rigidly, a full one its own matches.
constexpr double kShapeWeight = 1.0;
constexpr double kUnsupportedBoost = 12.0;
// Pull towards the global motion; decides only where nothing else does.
constexpr double kGlobalWeight = 0.02;

// Energy of one cell: for each corner, the squared distance to where the similarity that takes its
// two neighbours would put it. Rest positions are relative; a displacement enters linearly.
Matrix8d CellShapeEnergy(double cell_width, double cell_height) {
  const std::array<Eigen::Vector2d, 4> rest = {
      {{0.0, 0.0}, {cell_width, 0.0}, {0.0, cell_height}, {cell_width, cell_height}}};
  // corner, the corner it shares a vertical edge with, the corner across the other edge
  const std::array<std::array<std::size_t, 3>, 4> triangles = {
      {{0, 2, 3}, {1, 3, 2}, {2, 0, 1}, {3, 1, 0}}};
  Matrix8d energy = Matrix8d::Zero();
  for (const auto& [corner, base, tip] : triangles) {
    const Eigen::Vector2d edge = rest[tip] - rest[base];
    const Eigen::Vector2d turned(edge.y(), -edge.x());
    const Eigen::Vector2d offset = rest[corner] - rest[base];
    const double u = offset.dot(edge) / edge.squaredNorm();
    const double v = offset.dot(turned) / edge.squaredNorm();
    Eigen::Matrix2d turn;
    turn << 0.0, 1.0, -1.0, 0.0;
    const Eigen::Matrix2d along = u * Eigen::Matrix2d::Identity() + v * turn;
    Eigen::Matrix<double, 2, 8> residual = Eigen::Matrix<double, 2, 8>::Zero();
    residual.block<2, 2>(0, static_cast<Eigen::Index>(2 * corner)) += Eigen::Matrix2d::Identity();
    residual.block<2, 2>(0, static_cast<Eigen::Index>(2 * base)) +=
        along - Eigen::Matrix2d::Identity();
    residual.block<2, 2>(0, static_cast<Eigen::Index>(2 * tip)) -= along;
    energy += residual.transpose() * residual;
  }
  return energy;
}

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Which sub-frame along one side, for a position given as a share of that side.
std::size_t SubFrame(double share) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(kSubFrames);
  return std::min(static_cast<std::size_t>(position), kSubFrames - 1);
}

struct LocalSample {
  MeshGrid::Location location;
  Eigen::Vector2d displacement;  // beyond the global motion
  std::size_t sub_frame = 0;
};

// Second vote, per sub-frame: leaves out what moves unlike its neighbours.
std::vector<LocalSample> RejectLocally(const std::vector<LocalSample>& samples) {
  std::array<std::vector<std::size_t>, kSubFrames * kSubFrames> members;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    members[samples[i].sub_frame].push_back(i);
  }
  std::vector<LocalSample> kept;
  kept.reserve(samples.size());
  std::vector<double> xs;
  std::vector<double> ys;
  std::vector<double> deviations;
  for (const auto& sub_frame : members) {
    if (sub_frame.empty()) {
      continue;
    }
    xs.clear();
    ys.clear();
    deviations.clear();
    for (const std::size_t i : sub_frame) {
      xs.push_back(samples[i].displacement.x());
      ys.push_back(samples[i].displacement.y());
    }
    const Eigen::Vector2d median(Median(xs), Median(ys));
    for (const std::size_t i : sub_frame) {
      deviations.push_back((samples[i].displacement - median).norm());
    }
    const double tolerance = std::max(kMinLocalTolerance, kLocalTolerance * Median(deviations));
    for (const std::size_t i : sub_frame) {
      if ((samples[i].displacement - median).norm() <= tolerance) {
        kept.push_back(samples[i]);
      }
    }
  }
  return kept;
}

}  // namespace

struct MeshMotionSolver::Impl {
  explicit Impl(const MeshGrid& mesh)
      : grid(mesh), shape(CellShapeEnergy(1.0 / mesh.columns(), mesh.aspect() / mesh.rows())) {
    // Fix the sparsity pattern once: every cell couples its four vertices, x with y.
    const auto n = 2 * static_cast<Eigen::Index>(grid.num_vertices());
    std::vector<Eigen::Triplet<double>> triplets;
    for (int cell = 0; cell < grid.num_cells(); ++cell) {
      const auto dofs = CellDofs(cell);
      for (const Eigen::Index r : dofs) {
        for (const Eigen::Index c : dofs) {
          if (r >= c) {
            triplets.emplace_back(r, c, 1.0);
          }
        }
      }
    }
    normal.resize(n, n);
    normal.setFromTriplets(triplets.begin(), triplets.end());
    normal.makeCompressed();
    solver.analyzePattern(normal);
    entry.resize(static_cast<std::size_t>(grid.num_cells()));
    for (int cell = 0; cell < grid.num_cells(); ++cell) {
      const auto dofs = CellDofs(cell);
      auto& slots = entry[static_cast<std::size_t>(cell)];
      for (std::size_t r = 0; r < 8; ++r) {
        for (std::size_t c = 0; c < 8; ++c) {
          slots[r * 8 + c] = dofs[r] >= dofs[c] ? &normal.coeffRef(dofs[r], dofs[c]) : nullptr;
        }
      }
    }
  }

  [[nodiscard]] std::array<Eigen::Index, 8> CellDofs(int cell) const {
    std::array<Eigen::Index, 8> dofs{};
    const auto vertices = grid.CellVertices(cell);
    for (std::size_t i = 0; i < 4; ++i) {
      dofs[2 * i] = 2 * static_cast<Eigen::Index>(vertices[i]);
      dofs[2 * i + 1] = dofs[2 * i] + 1;
    }
    return dofs;
  }

  MeshGrid grid;
  Matrix8d shape;
  Eigen::SparseMatrix<double> normal;  // lower triangle
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver;
  std::vector<std::array<double*, 64>> entry;  // where a cell's 8x8 block lies in `normal`
};

MeshMotionSolver::MeshMotionSolver(const MeshGrid& grid) : impl_(std::make_unique<Impl>(grid)) {}
MeshMotionSolver::~MeshMotionSolver() = default;

std::vector<Eigen::Vector2d> MeshMotionSolver::Solve(std::span<const RectifiedMatch> matches,
                                                     const Eigen::Matrix3d& to_from) {
  Impl& s = *impl_;
  std::vector<LocalSample> samples;
  samples.reserve(matches.size());
  for (const RectifiedMatch& m : matches) {
    const auto expected = ProjectChecked(to_from, m.from);
    if (!expected) {
      continue;
    }
    const Eigen::Vector2d displacement = m.to - *expected;
    if (displacement.norm() > kMaxLocalMotion) {
      continue;
    }
    const std::size_t column = SubFrame(m.from.x() + 0.5);
    const std::size_t row = SubFrame(m.from.y() / s.grid.aspect() + 0.5);
    samples.push_back({s.grid.Locate(m.from), displacement, row * kSubFrames + column});
  }
  samples = RejectLocally(samples);
  if (samples.size() < kMinMatches) {
    return {};
  }

  const auto num_cells = static_cast<std::size_t>(s.grid.num_cells());
  std::vector<Eigen::Matrix4d> data(num_cells, Eigen::Matrix4d::Zero());
  std::vector<int> support(num_cells, 0);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(s.normal.rows());
  for (const LocalSample& sample : samples) {
    const auto cell = static_cast<std::size_t>(sample.location.cell);
    const Eigen::Vector4d w(sample.location.weights.data());
    data[cell].noalias() += w * w.transpose();
    ++support[cell];
    const auto vertices = s.grid.CellVertices(sample.location.cell);
    for (std::size_t i = 0; i < 4; ++i) {
      right.segment<2>(2 * static_cast<Eigen::Index>(vertices[i])) +=
          sample.location.weights[i] * sample.displacement;
    }
  }
  s.normal.coeffs().setZero();
  for (int cell = 0; cell < s.grid.num_cells(); ++cell) {
    const auto index = static_cast<std::size_t>(cell);
    const double alpha = kShapeWeight * (1.0 + kUnsupportedBoost / (1.0 + support[index]));
    for (std::size_t r = 0; r < 8; ++r) {
      for (std::size_t c = 0; c < 8; ++c) {
        double* slot = s.entry[index][r * 8 + c];
        if (slot == nullptr) {
          continue;
        }
        *slot += alpha * s.shape(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
        if (r % 2 == c % 2) {
          *slot += data[index](static_cast<Eigen::Index>(r / 2), static_cast<Eigen::Index>(c / 2));
        }
      }
    }
  }
  for (Eigen::Index i = 0; i < s.normal.rows(); ++i) {
    s.normal.coeffRef(i, i) += kGlobalWeight;
  }
  s.solver.factorize(s.normal);
  if (s.solver.info() != Eigen::Success) {
    return {};
  }
  const Eigen::VectorXd solution = s.solver.solve(right);
  std::vector<Eigen::Vector2d> displacement(static_cast<std::size_t>(s.grid.num_vertices()));
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    displacement[i] = solution.segment<2>(2 * static_cast<Eigen::Index>(i));
  }
  return displacement;
}

Eigen::Matrix3d CellHomography(const MeshGrid& grid, int cell, const Eigen::Matrix3d& to_from,
                               std::span<const Eigen::Vector2d> displacement) {
  const auto vertices = grid.CellVertices(cell);
  const int column = cell % grid.columns();
  const int row = cell / grid.columns();
  std::array<Eigen::Vector2d, 4> from;
  std::array<Eigen::Vector2d, 4> to;
  for (std::size_t i = 0; i < 4; ++i) {
    from[i] = grid.VertexPosition(column + static_cast<int>(i % 2), row + static_cast<int>(i / 2));
    to[i] = Project(to_from, from[i]) + displacement[static_cast<std::size_t>(vertices[i])];
  }
  const auto homography = HomographyFromFourPoints(from, to);
  return homography && InvertChecked(*homography) ? *homography : to_from;
}

}  // namespace rsstab::stabilizer
