// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/homography_mixture.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "evaluation/baselines/neighbour_tracks.h"
#include "igf/base/homography.h"

namespace rsstab::evaluation {
namespace {

constexpr std::size_t kLeastTracks = 60;
constexpr int kBlocks = 10;
constexpr int kPerBlock = 6;  // h11 h12 h13 h21 h22 h23
constexpr int kShared = 2;    // h31 h32
constexpr int kUnknowns = kBlocks * kPerBlock + kShared;
constexpr double kWeightSigma = 0.1;    // of the height: one block
constexpr double kNeighbourPull = 1.0;  // per unit of a matrix entry, in normalised points
constexpr int kReweightings = 8;
constexpr double kLeastResidual = 1e-3;  // normalised: half a pixel; below it weights are equal
constexpr int kFixedPoints = 6;

// Mixture weights at a row.
std::array<double, kBlocks> WeightsAt(double row, int height) {
  std::array<double, kBlocks> weights{};
  double sum = 0.0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double middle = (static_cast<double>(k) + 0.5) / kBlocks;
    const double distance = ((row + 0.5) / height - middle) / kWeightSigma;
    weights[k] = std::exp(-0.5 * distance * distance);
    sum += weights[k];
  }
  for (double& weight : weights) {
    weight /= sum;
  }
  return weights;
}

Eigen::Matrix3d MixtureAt(const std::vector<Eigen::Matrix3d>& blocks, double row, int height) {
  const auto weights = WeightsAt(std::clamp(row, 0.0, height - 1.0), height);
  Eigen::Matrix3d mixture = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < weights.size(); ++k) {
    mixture += weights[k] * blocks[k];
  }
  return mixture;
}

// Centre to 0, half the width to 1.
Eigen::Matrix3d Normalisation(int width, int height) {
  const double scale = 2.0 / width;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity();
  normal.diagonal() = Eigen::Vector3d(scale, scale, 1.0);
  normal.topRightCorner<2, 1>() = -scale / 2.0 * Eigen::Vector2d(width - 1.0, height - 1.0);
  return normal;
}

using Solution = Eigen::Matrix<double, kUnknowns, 1>;

std::vector<Eigen::Matrix3d> BlocksOf(const Solution& solution) {
  std::vector<Eigen::Matrix3d> blocks;
  for (int k = 0; k < kBlocks; ++k) {
    const auto h = solution.segment<kPerBlock>(k * kPerBlock);
    Eigen::Matrix3d block;
    block << h[0], h[1], h[2], h[3], h[4], h[5], solution[kUnknowns - 2], solution[kUnknowns - 1],
        1.0;
    blocks.push_back(block);
  }
  return blocks;
}

// The two rows of the linear system for one match: unknowns and right side.
struct Equations {
  Eigen::Matrix<double, 2, kUnknowns> left = Eigen::Matrix<double, 2, kUnknowns>::Zero();
  Eigen::Vector2d right;
};

Equations EquationsOf(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                      const std::array<double, kBlocks>& weights) {
  Equations equations;
  for (int k = 0; k < kBlocks; ++k) {
    const Eigen::RowVector3d point =
        weights[static_cast<std::size_t>(k)] * from.homogeneous().transpose();
    equations.left.block<1, 3>(0, k * kPerBlock) = point;
    equations.left.block<1, 3>(1, k * kPerBlock + 3) = point;
  }
  equations.left.block<1, kShared>(0, kUnknowns - kShared) = -to.x() * from.transpose();
  equations.left.block<1, kShared>(1, kUnknowns - kShared) = -to.y() * from.transpose();
  equations.right = to;
  return equations;
}

// How the picture moves in one frame interval at each block's time: a matrix logarithm per block,
// in pixels of `width` x `height`, mean over the frame pairs. Empty when one does not exist.
std::vector<Eigen::Matrix3d> Generators(const std::vector<PointTracks>& pairs, int width,
                                        int height) {
  std::vector<Eigen::Matrix3d> generators(kBlocks, Eigen::Matrix3d::Zero());
  for (const PointTracks& tracks : pairs) {
    // Rows of the picture itself: the later frame of the first pair, the earlier of the second.
    const auto blocks = FitHomographyMixture(tracks, tracks.from_time_s == 0.0);
    if (blocks.empty()) {
      return {};
    }
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const Eigen::Matrix3d block =
          RescaleHomography(blocks[k], tracks.width, tracks.height, width, height);
      const Eigen::Matrix3d logarithm = (block / std::cbrt(block.determinant())).log();
      generators[k] += logarithm / static_cast<double>(pairs.size());
    }
  }
  const bool are_finite = std::all_of(generators.begin(), generators.end(),
                                      [](const Eigen::Matrix3d& g) { return g.allFinite(); });
  return are_finite ? generators : std::vector<Eigen::Matrix3d>();
}

}  // namespace

std::vector<Eigen::Matrix3d> FitHomographyMixture(const PointTracks& tracks, bool by_from) {
  const Eigen::Matrix3d normal = Normalisation(tracks.width, tracks.height);
  std::vector<Equations> equations;
  for (const PointMatch& match : tracks.matches) {
    const double row = static_cast<double>(by_from ? match.from.y() : match.to.y());
    equations.push_back(EquationsOf(Project(normal, match.from.cast<double>()),
                                    Project(normal, match.to.cast<double>()),
                                    WeightsAt(row, tracks.height)));
  }
  std::vector<double> weights(equations.size(), 1.0);
  Solution solution = Solution::Zero();
  for (int round = 0; round < kReweightings; ++round) {
    Eigen::Matrix<double, kUnknowns, kUnknowns> matrix =
        1e-9 * Eigen::Matrix<double, kUnknowns, kUnknowns>::Identity();
    Solution right = Solution::Zero();
    for (std::size_t i = 0; i < equations.size(); ++i) {
      matrix += weights[i] * equations[i].left.transpose() * equations[i].left;
      right += weights[i] * equations[i].left.transpose() * equations[i].right;
    }
    for (int k = 0; k + 1 < kBlocks; ++k) {
      for (int i = 0; i < kPerBlock; ++i) {
        const int a = k * kPerBlock + i;
        const int b = a + kPerBlock;
        matrix(a, a) += kNeighbourPull;
        matrix(b, b) += kNeighbourPull;
        matrix(a, b) -= kNeighbourPull;
        matrix(b, a) -= kNeighbourPull;
      }
    }
    solution = matrix.ldlt().solve(right);
    if (!solution.allFinite()) {
      return {};
    }
    for (std::size_t i = 0; i < equations.size(); ++i) {
      const double residual = (equations[i].left * solution - equations[i].right).norm();
      weights[i] = 1.0 / std::max(residual, kLeastResidual) * kLeastResidual;  // L1
    }
  }
  std::vector<Eigen::Matrix3d> blocks = BlocksOf(solution);
  for (Eigen::Matrix3d& block : blocks) {
    block = normal.inverse() * block * normal;
    if (!(block.determinant() > 0.0)) {
      return {};
    }
  }
  return blocks;
}

Result<MethodAnswer> HomographyMixtureMethod::Estimate(const MethodInput& input) {
  const auto pairs = TrackNeighbours(input, kLeastTracks);
  if (!pairs) {
    return Propagate(pairs.error());
  }
  const int width = input.rs.width;
  const int height = input.rs.height;
  const auto generators = Generators(*pairs, width, height);
  if (generators.empty()) {
    return Fail(ErrorCode::kUntrustworthy, "the tracks do not determine the motion of each block");
  }
  // From the reference row's instant to each row's, one row after the other.
  const double step = readout_share_ / height;
  const auto reference =
      static_cast<std::size_t>(std::clamp(std::lround(input.ReferenceRow()), 0L, height - 1L));
  std::vector<Eigen::Matrix3d> row_from_reference(static_cast<std::size_t>(height),
                                                  Eigen::Matrix3d::Identity());
  for (std::size_t row = reference + 1; row < row_from_reference.size(); ++row) {
    const Eigen::Matrix3d motion =
        step * MixtureAt(generators, static_cast<double>(row) - 0.5, height);
    row_from_reference[row] = motion.exp() * row_from_reference[row - 1];
  }
  for (std::size_t row = reference; row-- > 0;) {
    const Eigen::Matrix3d motion =
        -step * MixtureAt(generators, static_cast<double>(row) + 0.5, height);
    row_from_reference[row] = motion.exp() * row_from_reference[row + 1];
  }
  const FieldGrid grid;
  MethodAnswer answer{MotionField(width, height, grid.columns, grid.rows), {}};
  answer.field.set_reference_row(input.ReferenceRow());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2d pixel = answer.field.VertexPosition(column, row);
      Eigen::Vector2d source = pixel;
      for (int i = 0; i < kFixedPoints; ++i) {
        const long at = std::clamp(std::lround(source.y()), 0L, height - 1L);
        source = Project(row_from_reference[static_cast<std::size_t>(at)], pixel);
      }
      answer.field.At(column, row) = (source - pixel).cast<float>();
    }
  }
  return answer;
}

}  // namespace rsstab::evaluation
