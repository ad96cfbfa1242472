// SPDX-License-Identifier: Apache-2.0
// Advice for a recording before it is made. Each change is tried on the plan itself.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/planning/recording_plan.h"

namespace moiregauge::internal {

// Returns a length with two digits in a suitable unit: "0.46 um", "12 um", "1.2 mm".
[[nodiscard]] std::string length_text(double mm);

// Returns sentences, the most important first. None: no change helps.
[[nodiscard]] std::vector<std::string> advice_for(const RecordingSetup& setup, bool readout_unknown);

}  // namespace moiregauge::internal
