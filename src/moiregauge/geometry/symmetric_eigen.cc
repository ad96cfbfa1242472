// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/geometry/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

namespace moiregauge::internal {

SymmetricEigen2 eigen_of(const Eigen::Matrix2d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigenX eigen_of(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::Matrix2d symmetric_root(const Eigen::Matrix2d& positive) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(positive).operatorSqrt();
}

}  // namespace moiregauge::internal
