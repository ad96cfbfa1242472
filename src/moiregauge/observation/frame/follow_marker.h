// SPDX-License-Identifier: Apache-2.0
// A target's raster reading in one frame, the window going with it.
#pragma once

#include <cmath>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

[[nodiscard]] Loss loss_of(const PatchReading& then, const PatchReading& patch);

// An axis that the print does not show counts as not moved.
[[nodiscard]] inline Extent<frame::Board> known_part(Extent<frame::Board> d) {
  return {std::isnan(d.x) ? 0.0 : d.x, std::isnan(d.y) ? 0.0 : d.y};
}

// The window goes with a travelling target: first to `travel`, where the last frame left it, then to where this one
// finds it, or the print's edge would come into the window before half a pitch is reached.
void follow_marker(const GreyPicture& picture, const Reference& reference, const View& view, std::size_t i,
                   Extent<frame::Board> travel, MarkerObservation& seen, PatchWorkspace& work);

}  // namespace moiregauge::internal
