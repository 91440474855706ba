// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_SYNC_COVARIANCE_H_
#define RSSTAB_IGF_SYNC_COVARIANCE_H_

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

namespace ceres {
struct CRSMatrix;
}

namespace rsstab::igf {

// Standard deviations of the first `num_parameters` parameters of a robust least-squares fit whose
// errors are not independent: the sandwich B^-1 M B^-1, with B the normal matrix and M the sum over
// groups of g g^T, g being a group's gradient, and of its products with the `lag` groups before it,
// weighted down linearly (Newey and West, Econometrica 1987). Unlike s^2 B^-1 it holds when the
// errors of a frame pair's tracks, and of neighbouring pairs, go together (parallax, gyro noise, a
// lens or motion that the model lacks).
//
// `jacobian` and `residuals` as Ceres evaluates them, loss applied. Rows: group after group, as
// many as `rows_of_group` says, then rows that belong to no group (priors). Columns: the parameters
// in question, 0 throughout for one held constant (its deviation is 0), then nuisances of two
// columns each, of which a row touches one at most; these are eliminated. Empty when the parameters
// are not determined.
[[nodiscard]] std::optional<Eigen::VectorXd> SandwichSigma(const ceres::CRSMatrix& jacobian,
                                                           std::span<const double> residuals,
                                                           std::span<const int> rows_of_group,
                                                           std::size_t num_parameters,
                                                           std::size_t lag);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_SYNC_COVARIANCE_H_
