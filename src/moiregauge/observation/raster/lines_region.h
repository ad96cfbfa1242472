// SPDX-License-Identifier: Apache-2.0
// Lines do not show movement along themselves. The window cannot follow it, so an end of the grating may enter the
// window.
#pragma once

#include "moiregauge/phase/sampling_moire/sampling_moire.h"

namespace moiregauge::internal {

struct LinesRegion {
  RegionPhase phase;  // at the middle of the whole region, as by region_mean
  // Share of the region's length along the lines that was used.
  double share = 1.0;
};

// Returns the mean phase over the part of the region (the whole field) that still shows the grating. Its modulation there is at least
// half of the region's largest. The plane gives the phase at the middle of the whole region.
// Fails (phase.valid = false): less than one sampling pitch of the length is left.
[[nodiscard]] LinesRegion region_mean_of_lines(const FringeField& field, Axis axis);

}  // namespace moiregauge::internal
