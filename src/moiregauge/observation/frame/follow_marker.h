// SPDX-License-Identifier: Apache-2.0
// Reads a target by a raster whose window moves with it.
#pragma once

#include <cmath>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Returns the reason why a reading is lost, if it is. `then` is the reading of the reference frame.
[[nodiscard]] Loss loss_of(const PatchReading& then, const PatchReading& patch);

// Returns `d` with 0 for an axis that the grating does not show.
[[nodiscard]] inline Extent<frame::Board> known_part(Extent<frame::Board> d) {
  return {std::isnan(d.x) ? 0.0 : d.x, std::isnan(d.y) ? 0.0 : d.y};
}

// Reads a target in a window that moves with it: first to `travel`, its position in the last frame, then to the
// position found. In a fixed window the grating's edge would enter before half a pitch.
void follow_marker(const BoardPicture& now, const Reference& reference, std::size_t i, Extent<frame::Board> travel,
                   MarkerObservation& seen);

}  // namespace moiregauge::internal
