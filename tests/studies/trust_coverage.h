// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal::study {

// Prints the coverage of 1.96 u: one row per scenario whose name begins with `only`.
void print_coverage(int runs, const std::string& only, bool verbose);

}  // namespace moiregauge::internal::study
