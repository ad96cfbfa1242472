// SPDX-License-Identifier: Apache-2.0
// Eigenvalues of symmetric matrices. Compiled once, because Eigen's solver takes seconds of compile time per file.
#pragma once

#include <Eigen/Core>

namespace moiregauge::internal {

template <typename Values, typename Vectors>
struct SymmetricEigen {
  Values values;    // in increasing order
  Vectors vectors;  // unit length, as columns
};

using SymmetricEigen2 = SymmetricEigen<Eigen::Vector2d, Eigen::Matrix2d>;
using SymmetricEigenX = SymmetricEigen<Eigen::VectorXd, Eigen::MatrixXd>;

// Returns eigenvalues and eigenvectors of a symmetric matrix. Reads its lower triangle only.
[[nodiscard]] SymmetricEigen2 eigen_of(const Eigen::Matrix2d& symmetric);
[[nodiscard]] SymmetricEigenX eigen_of(const Eigen::MatrixXd& symmetric);

// Returns the symmetric square root of a positive matrix.
[[nodiscard]] Eigen::Matrix2d symmetric_root(const Eigen::Matrix2d& positive);

}  // namespace moiregauge::internal
