// SPDX-License-Identifier: Apache-2.0
// Which of the circles in a picture are the markers round everything else.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/markers/circles.h"
#include "moiregauge/markers/grating_patches.h"

namespace moiregauge {

// Circles of one size (the size most of them have) that lie on, or next to, the convex hull of all of that size. Circles
// inside a grating are its elements and do not count; of concentric ones only the strongest does. Where four or more stand
// beside gratings of their own all in the same way (like_sheets.h), only those count: the others are look-alikes.
[[nodiscard]] std::vector<SeenCircle> outermost_circles(std::span<const SeenCircle> circles, std::span<const SeenPatch> patches);

// Index of the points on their convex hull or within `slack` px of it.
[[nodiscard]] std::vector<std::size_t> on_hull(std::span<const ImagePoint> points, double slack);

}  // namespace moiregauge
