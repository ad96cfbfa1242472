// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/long_run_covariance.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {

using Eigen::Index;

double first_autocorrelation(const Eigen::VectorXd& residual) {
  const double sum = residual.squaredNorm();
  if (residual.size() < 2 || !(sum > 0.0)) return 0.0;
  return residual.head(residual.size() - 1).dot(residual.tail(residual.size() - 1)) / sum;
}

Eigen::MatrixXd long_run_covariance(const Eigen::MatrixXd& moments, const Eigen::VectorXd& residual) {
  constexpr double kMaxCorrelation = 0.97;  // keeps the bandwidth finite
  const double n = static_cast<double>(moments.rows());
  const double rho = std::clamp(first_autocorrelation(residual), -kMaxCorrelation, kMaxCorrelation);
  const double alpha = 4.0 * rho * rho / std::pow((1.0 - rho) * (1.0 + rho), 2.0);
  const double bandwidth = std::min(1.1447 * std::cbrt(alpha * n), 0.25 * n);
  Eigen::MatrixXd sum = moments.transpose() * moments;
  for (Index lag = 1; lag < moments.rows() && static_cast<double>(lag) <= bandwidth; ++lag) {
    const Index rows = moments.rows() - lag;
    const Eigen::MatrixXd at_lag = moments.topRows(rows).transpose() * moments.bottomRows(rows);
    sum += (1.0 - static_cast<double>(lag) / (bandwidth + 1.0)) * (at_lag + at_lag.transpose());
  }
  return sum;
}

}  // namespace moiregauge::internal
