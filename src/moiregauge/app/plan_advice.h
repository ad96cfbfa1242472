// SPDX-License-Identifier: Apache-2.0
// What to change about a recording before it is made, each tried on the plan itself.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/planning/recording_plan.h"

namespace moiregauge::internal {

// "0.46 um", "12 um", "1.2 mm": two digits, in the unit that suits.
[[nodiscard]] std::string length_text(double mm);

// Sentences, the most pressing first; none: nothing to better.
[[nodiscard]] std::vector<std::string> advice_for(const RecordingSetup& setup, bool rolls_untold);

}  // namespace moiregauge::internal
