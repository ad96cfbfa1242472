// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal::study {

// Prints the share of runs in which a step of one reference is reported, with the right or a wrong name. The step is
// 0.2 px at a random frame. Also prints the share of false alarms without a step.
void print_reference_faults(int draws, const std::string& only, bool verbose);

}  // namespace moiregauge::internal::study
