// SPDX-License-Identifier: Apache-2.0
// What the user should know about the frames of an input as a whole: how many were damaged, and where time jumps.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/observation/reference/observations.h"

namespace moiregauge::internal {

// One sentence each, none where all is well. A sentence that starts with "note: " is about a property of the input, not
// about a fault. A gap in time is one that is half as long again as the median interval of a frame; damaged frames,
// which may have lost their times, count neither way.
[[nodiscard]] std::vector<std::string> notes_on_frames(const Observations& frames);

}  // namespace moiregauge::internal
