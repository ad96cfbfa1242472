// SPDX-License-Identifier: Apache-2.0
// Circles that are dots of a print, not markers.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/gratings/grating_patches.h"

namespace moiregauge::internal {

// The circles that are no elements of a grating: neither inside its outline, nor in step with those inside where the
// print goes on beyond it (a sheet partly covered, or cut along other lines than its print's).
[[nodiscard]] std::vector<DetectedCircle> without_elements(std::span<const DetectedCircle> circles,
                                                           std::span<const DetectedPatch> patches);

}  // namespace moiregauge::internal
