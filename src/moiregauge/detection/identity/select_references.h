// SPDX-License-Identifier: Apache-2.0
// Selects the circles that are probably references: the outermost ones of a common size.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/gratings/grating_patches.h"

namespace moiregauge::internal {

struct OutermostCircles {
  std::vector<DetectedCircle> circles;
  // True if three circles are on matching sheets (matching_sheets.h), but `circles` is not those and one more. The
  // fourth reference is then ambiguous.
  bool doubtful = false;
};

// Returns the circles of the most frequent size that are on their convex hull, or within half a diameter of it.
// Elements of a grating and circles that are round on no grating's plane are excluded. Only one of several concentric
// circles counts, the one with the highest contrast. If four or more circles are on matching sheets
// (matching_sheets.h), all others are false candidates.
[[nodiscard]] OutermostCircles outermost_circles(std::span<const DetectedCircle> circles,
                                                 std::span<const DetectedPatch> patches);

// Returns the indices of the points on their convex hull or within `slack` px of it.
[[nodiscard]] std::vector<std::size_t> on_hull(std::span<const ImagePoint> points, double slack);

}  // namespace moiregauge::internal
