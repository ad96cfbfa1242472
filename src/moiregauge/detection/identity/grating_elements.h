// SPDX-License-Identifier: Apache-2.0
// Removes circles that are dots of a grating and no markers.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/gratings/grating_patches.h"

namespace moiregauge::internal {

// Returns the circles that are no elements of a grating. Elements are the circles inside a patch's outline (plus half a
// pitch) and those that continue its lattice beyond the outline. A grating extends beyond its patch if it is partly
// covered, or if its sheet is not cut along the grating's axes.
[[nodiscard]] std::vector<DetectedCircle> without_elements(std::span<const DetectedCircle> circles,
                                                           std::span<const DetectedPatch> patches);

}  // namespace moiregauge::internal
