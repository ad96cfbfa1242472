// SPDX-License-Identifier: Apache-2.0
// Prints of parallel lines move along themselves unseen: the window cannot go along, and one end of the print comes
// into it.
#pragma once

#include "moiregauge/phase/sampling_moire/sampling_moire.h"

namespace moiregauge::internal {

struct LinesRegion {
  RegionPhase phase;   // at the middle of the whole region, as region_mean gives it
  double share = 1.0;  // of the region's length along the lines that was used
};

// The mean phase over that part of the region, along the lines, in which the print still is: its modulation is at least
// half of the strongest there. Not valid where less than one sampling pitch of it is left. The middle's phase follows
// from the plane.
[[nodiscard]] LinesRegion region_mean_of_lines(const FringeField& field, Axis axis, double pitch_px, int region_px);

}  // namespace moiregauge::internal
