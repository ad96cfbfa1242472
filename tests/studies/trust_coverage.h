// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal::study {

// How often the truth lies within 1.96 u: one row for each scenario whose name begins with `only`.
void print_coverage(int runs, const std::string& only, bool verbose);

}  // namespace moiregauge::internal::study
