// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace moiregauge::internal {

// Of normal equations whose unknowns have units of their own: by LDL' of the matrix scaled to a diagonal of ones.
[[nodiscard]] Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& normal);

}  // namespace moiregauge::internal
