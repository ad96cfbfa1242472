// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/normal_inverse.h"

#include <Eigen/Cholesky>

namespace moiregauge::internal {

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& normal) {
  const auto rows = normal.rows();
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      (scale.asDiagonal() * normal * scale.asDiagonal()).ldlt().solve(Eigen::MatrixXd::Identity(rows, rows));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

}  // namespace moiregauge::internal
