// SPDX-License-Identifier: Apache-2.0
#include "igf/sync_covariance.h"

#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace rsstab::igf {
namespace {

// A dense matrix in Ceres' form.
ceres::CRSMatrix Sparse(const Eigen::MatrixXd& dense) {
  ceres::CRSMatrix m;
  m.num_rows = static_cast<int>(dense.rows());
  m.num_cols = static_cast<int>(dense.cols());
  m.rows.push_back(0);
  for (Eigen::Index row = 0; row < dense.rows(); ++row) {
    for (Eigen::Index column = 0; column < dense.cols(); ++column) {
      if (dense(row, column) != 0.0) {
        m.cols.push_back(static_cast<int>(column));
        m.values.push_back(dense(row, column));
      }
    }
    m.rows.push_back(static_cast<int>(m.values.size()));
  }
  return m;
}

constexpr int kGroups = 400;
constexpr int kRows = 4;

// The mean of kGroups * kRows readings; `shared` is the part of the noise that a group has in
// common.
double SigmaOfMean(double own, double shared, std::size_t lag) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  std::vector<double> residuals;
  for (int group = 0; group < kGroups; ++group) {
    const double common = shared * noise(random);
    for (int row = 0; row < kRows; ++row) {
      residuals.push_back(common + own * noise(random));
    }
  }
  const std::vector<int> rows(kGroups, kRows);
  return (*SandwichSigma(Sparse(Eigen::MatrixXd::Ones(kGroups * kRows, 1)), residuals, rows, 1,
                         lag))(0);
}

TEST(SyncCovariance, IndependentErrorsGiveTheTextbookAnswer) {
  const double expected = 1.0 / std::sqrt(kGroups * kRows);
  EXPECT_NEAR(SigmaOfMean(1.0, 0.0, 0), expected, 0.1 * expected);
  EXPECT_NEAR(SigmaOfMean(1.0, 0.0, 5), expected, 0.25 * expected);
}

TEST(SyncCovariance, SharedErrorsCountOncePerGroup) {
  const double expected = 1.0 / std::sqrt(kGroups);
  EXPECT_NEAR(SigmaOfMean(0.0, 1.0, 0), expected, 0.1 * expected);
}

// y = a x + drift: with a free drift, only the spread of x about its mean tells a.
TEST(SyncCovariance, NuisancesAreEliminated) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  const int rows = 2000;
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(rows, 3);
  std::vector<double> residuals;
  for (int row = 0; row < rows; ++row) {
    j(row, 0) = 5.0 + (row % 2 == 0 ? 1.0 : -1.0);
    j(row, 1) = 1.0;
    residuals.push_back(noise(random));
  }
  j(0, 2) = 1e-3;  // the second component of the drift is hardly seen
  const std::vector<int> groups(static_cast<std::size_t>(rows / 2), 2);
  const auto sigma = SandwichSigma(Sparse(j), residuals, groups, 1, 0);
  ASSERT_TRUE(sigma);
  const double expected = 1.0 / std::sqrt(rows);
  EXPECT_NEAR((*sigma)(0), expected, 0.1 * expected);
}

TEST(SyncCovariance, ConstantParametersHaveNone) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(8, 2);
  j.col(1).setOnes();
  const std::vector<double> residuals = {1, -1, 1, -1, 1, -1, 1, -1.5};
  const std::vector<int> groups = {2, 2, 2, 2};
  const auto sigma = SandwichSigma(Sparse(j), residuals, groups, 2, 0);
  ASSERT_TRUE(sigma);
  EXPECT_EQ((*sigma)(0), 0.0);
  EXPECT_GT((*sigma)(1), 0.0);
  const std::vector<int> one_group = {8};
  EXPECT_FALSE(SandwichSigma(Sparse(j), residuals, one_group, 2, 0));
}

}  // namespace
}  // namespace rsstab::igf
