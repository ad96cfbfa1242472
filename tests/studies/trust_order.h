// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal::study {

// Many targets on a board jump by fractions and multiples of their pitch from frame to frame: how many samples called
// `ok` are off by more than a quarter of a pitch. `samples`: of targets in frames, over all rows together.
void print_orders(int samples, const std::string& only, bool verbose);

}  // namespace moiregauge::internal::study
