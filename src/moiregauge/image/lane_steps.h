// SPDX-License-Identifier: Apache-2.0
// Numbers of a vector's lanes. Iota of Highway 1.0 stores them one by one and loads them as a vector. The load then waits
// for all stores, a tenth of the time of a loop over pixels.
#pragma once

namespace moiregauge::internal {

// For loads of up to sixteen lanes: add the first one's value.
template <typename T>
alignas(64) inline constexpr T kLaneSteps[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

}  // namespace moiregauge::internal
