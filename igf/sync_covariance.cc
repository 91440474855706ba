// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_covariance.h"

#include <ceres/crs_matrix.h>

#include <Eigen/LU>
#include <vector>

namespace rsstab::igf {
namespace {

// The leading columns, with what the nuisances could explain of them taken out:
// J_p - J_n (J_n^T J_n)^-1 J_n^T J_p, nuisance by nuisance.
Eigen::MatrixXd WithoutNuisances(const ceres::CRSMatrix& jacobian, int num_parameters) {
  Eigen::MatrixXd leading = Eigen::MatrixXd::Zero(jacobian.num_rows, num_parameters);
  Eigen::MatrixXd nuisance = Eigen::MatrixXd::Zero(jacobian.num_rows, 2);
  std::vector<int> nuisance_of_row(static_cast<std::size_t>(jacobian.num_rows), -1);
  for (int row = 0; row < jacobian.num_rows; ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (int k = jacobian.rows[r]; k < jacobian.rows[r + 1]; ++k) {
      const int column = jacobian.cols[static_cast<std::size_t>(k)];
      const double value = jacobian.values[static_cast<std::size_t>(k)];
      if (column < num_parameters) {
        leading(row, column) = value;
      } else {
        nuisance(row, (column - num_parameters) % 2) = value;
        nuisance_of_row[r] = (column - num_parameters) / 2;
      }
    }
  }
  const auto count = static_cast<std::size_t>((jacobian.num_cols - num_parameters) / 2);
  std::vector<Eigen::Matrix2d> normal(count, Eigen::Matrix2d::Zero());
  std::vector<Eigen::MatrixXd> mixed(count, Eigen::MatrixXd::Zero(2, num_parameters));
  for (int row = 0; row < jacobian.num_rows; ++row) {
    if (const int d = nuisance_of_row[static_cast<std::size_t>(row)]; d >= 0) {
      const auto index = static_cast<std::size_t>(d);
      normal[index] += nuisance.row(row).transpose() * nuisance.row(row);
      mixed[index] += nuisance.row(row).transpose() * leading.row(row);
    }
  }
  for (std::size_t d = 0; d < count; ++d) {
    mixed[d] = Eigen::FullPivLU<Eigen::Matrix2d>(normal[d]).solve(mixed[d]).eval();
  }
  for (int row = 0; row < jacobian.num_rows; ++row) {
    if (const int d = nuisance_of_row[static_cast<std::size_t>(row)]; d >= 0) {
      leading.row(row) -= nuisance.row(row) * mixed[static_cast<std::size_t>(d)];
    }
  }
  return leading;
}

}  // namespace

std::optional<Eigen::VectorXd> SandwichSigma(const ceres::CRSMatrix& jacobian,
                                             std::span<const double> residuals,
                                             std::span<const int> rows_of_group,
                                             std::size_t num_parameters, std::size_t lag) {
  const Eigen::MatrixXd j = WithoutNuisances(jacobian, static_cast<int>(num_parameters));
  const Eigen::Map<const Eigen::VectorXd> r(residuals.data(),
                                            static_cast<Eigen::Index>(residuals.size()));
  Eigen::MatrixXd bread = j.transpose() * j;
  for (Eigen::Index i = 0; i < bread.rows(); ++i) {
    if (bread(i, i) == 0.0) {
      bread(i, i) = 1.0;  // held constant: its row and column of M are 0
    }
  }
  std::vector<Eigen::VectorXd> gradients;
  Eigen::Index begin = 0;
  for (const int rows : rows_of_group) {
    gradients.emplace_back(j.middleRows(begin, rows).transpose() * r.segment(begin, rows));
    begin += rows;
  }
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(bread.rows(), bread.cols());
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    meat += gradients[i] * gradients[i].transpose();
    for (std::size_t back = 1; back <= lag && back <= i; ++back) {
      const double weight = 1.0 - static_cast<double>(back) / (static_cast<double>(lag) + 1.0);
      const Eigen::MatrixXd cross = gradients[i] * gradients[i - back].transpose();
      meat += weight * (cross + cross.transpose());
    }
  }
  const auto n = static_cast<double>(gradients.size());
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(bread);
  if (gradients.size() < 2 || !lu.isInvertible()) {
    return std::nullopt;
  }
  const Eigen::MatrixXd inverse = lu.inverse();
  return Eigen::VectorXd(
      (n / (n - 1.0) * inverse * meat * inverse).diagonal().cwiseMax(0.0).cwiseSqrt());
}

}  // namespace rsstab::igf
