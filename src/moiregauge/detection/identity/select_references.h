// SPDX-License-Identifier: Apache-2.0
// Which of the circles in a picture are the markers round everything else.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/gratings/grating_patches.h"

namespace moiregauge::internal {

struct OutermostCircles {
  std::vector<DetectedCircle> circles;
  // Three circles stand beside gratings of their own all in the same way, but `circles` is not those and one more:
  // which is the fourth reference would be a guess.
  bool doubtful = false;
};

// Circles of one size (the size most of them have) that lie on, or next to, the convex hull of all of that size.
// Circles inside a grating are its elements and do not count, nor does what is round on no grating's plane; of
// concentric ones only the strongest counts. Where four or more stand beside gratings of their own all in the same way
// (matching_sheets.h), only those count: the others are look-alikes.
[[nodiscard]] OutermostCircles outermost_circles(std::span<const DetectedCircle> circles,
                                                 std::span<const DetectedPatch> patches);

// Index of the points on their convex hull or within `slack` px of it.
[[nodiscard]] std::vector<std::size_t> on_hull(std::span<const ImagePoint> points, double slack);

}  // namespace moiregauge::internal
