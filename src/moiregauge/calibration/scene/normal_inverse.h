// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace moiregauge::internal {

// Returns the inverse of a normal matrix whose unknowns have different units (LDL' after scaling to a unit diagonal).
[[nodiscard]] Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& normal);

}  // namespace moiregauge::internal
