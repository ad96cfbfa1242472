// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal::study {

// One reference of several slips by 0.2 px at a random moment: how often that is noticed, and the right one named; and
// how often references that stand still are suspected.
void print_reference_faults(int draws, const std::string& only, bool verbose);

}  // namespace moiregauge::internal::study
