// SPDX-License-Identifier: Apache-2.0
// Notes for the user on the frames of an input: damaged frames and gaps in time.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/observation/reference/observations.h"

namespace moiregauge::internal {

// Returns one sentence per note, none for a regular input. A sentence that starts with "note: " describes a property of
// the input, not a fault.
// A gap is an interval per frame above 1.5 times the median. Damaged frames are ignored there, because their times may
// be wrong.
[[nodiscard]] std::vector<std::string> notes_on_frames(const Observations& frames);

}  // namespace moiregauge::internal
