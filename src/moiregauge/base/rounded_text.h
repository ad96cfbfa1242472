// SPDX-License-Identifier: Apache-2.0
// Rounding of values for people: as many decimals as the uncertainty justifies.
#pragma once

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {

// Returns the number of decimals that show two significant digits of an expanded uncertainty, from 0 to `max`.
[[nodiscard]] inline int decimals_for(double expanded, int max = 6) {
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(std::max(expanded, 1e-15)))), 0, max);
}

}  // namespace moiregauge::internal
