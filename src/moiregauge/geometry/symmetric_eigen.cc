// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/geometry/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

namespace moiregauge::internal {

// A solver for the fixed size has the same bits, but takes longer to compile.
SymmetricEigen2 eigen_of(const Eigen::Matrix2d& symmetric) {
  const SymmetricEigenX eigen = eigen_of(Eigen::MatrixXd(symmetric));
  return {eigen.values, eigen.vectors};
}

SymmetricEigenX eigen_of(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::Matrix2d symmetric_root(const Eigen::Matrix2d& positive) {
  const SymmetricEigen2 eigen = eigen_of(positive);
  return eigen.vectors * eigen.values.cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
}

}  // namespace moiregauge::internal
