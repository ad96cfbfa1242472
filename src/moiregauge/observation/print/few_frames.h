// SPDX-License-Identifier: Apache-2.0
// Statistics of few frames.
#pragma once

namespace moiregauge::internal {

// Least number of frames with movement: a single jump of the target decides nothing. Chosen.
inline constexpr double kMinMovingFrames = 5.0;

// Returns the factor by which few degrees of freedom enlarge u, so that 4 u are as rare as 4 sigma. Student's t is
// expanded for large degrees of freedom (Abramowitz and Stegun 26.7.5).
[[nodiscard]] constexpr double enlargement_of_few(double freedom) {
  return 1.0 + 4.25 / freedom + 16.0 / (freedom * freedom);
}

}  // namespace moiregauge::internal
