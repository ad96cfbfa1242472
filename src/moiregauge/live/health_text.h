// SPDX-License-Identifier: Apache-2.0
// Words about the condition of a live run.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/live/publisher.h"

namespace moiregauge::internal {

// Returns what is wrong with the images or the run, each with its remedy. Empty: nothing.
[[nodiscard]] std::vector<std::string> health_hints(const LiveHealth& health);

// Returns lost frames and their reasons, e.g. "3 lost (2 queue full, 1 incomplete)".
[[nodiscard]] std::string lost_text(const LostFrames& lost);

}  // namespace moiregauge::internal
