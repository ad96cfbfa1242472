// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal::study {

// Prints the number of `ok` samples with an error above a quarter of a pitch. Many targets on a board jump by fractions
// and multiples of their pitch from frame to frame. `samples` is the number of samples over all rows of the table.
void print_orders(int samples, const std::string& only, bool verbose);

}  // namespace moiregauge::internal::study
