// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {

// What chi2 of so many degrees of freedom exceeds by chance once in a thousand times (Wilson and Hilferty 1931,
// doi:10.1073/pnas.17.12.684). Of few degrees it is skew: dof + 3 sqrt(2 dof) would be exceeded fifteen times as often.
[[nodiscard]] inline double chi2_upper_quantile(double dof) {
  constexpr double kOnceInAThousand = 3.09;  // standard deviations of a normal variable
  const double v = 2.0 / (9.0 * std::max(dof, 1e-9)), root = 1.0 - v + kOnceInAThousand * std::sqrt(v);
  return dof * root * root * root;
}

}  // namespace moiregauge::internal
