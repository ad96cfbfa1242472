// SPDX-License-Identifier: Apache-2.0
// Covariance of a sum of autocorrelated errors.
#pragma once

#include <Eigen/Core>

namespace moiregauge::internal {

// Returns the covariance of the sum of the rows of `moments` (one row per sample in time order, mean 0). Products of
// rows up to a lag enter, with Bartlett's weights (Newey and West, Econometrica 55, 1987, 703-708). The largest lag
// follows from the first autocorrelation of `residual` (Andrews, Econometrica 59, 1991, Eq. (6.4)), at most a quarter of
// the rows.
// Error: too small for errors that are correlated over more than about a tenth of the record.
[[nodiscard]] Eigen::MatrixXd long_run_covariance(const Eigen::MatrixXd& moments, const Eigen::VectorXd& residual);

// Returns the correlation of neighbours of a series with mean 0.
[[nodiscard]] double first_autocorrelation(const Eigen::VectorXd& residual);

}  // namespace moiregauge::internal
