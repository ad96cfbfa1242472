// SPDX-License-Identifier: Apache-2.0
// Detects sheets printed from one template: circles with a grating next to each, all in the same relative position. A
// false candidate has no grating next to it, or one in another relative position.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/gratings/grating_patches.h"

namespace moiregauge::internal {

struct LikeSheet {
  std::size_t circle = 0;  // index into the circles
  std::size_t patch = 0;   // index into the patches
};

// Largest distance of a grating's edge from the centre of its circle, in diameters of the circle (chosen).
inline constexpr double kGratingReach = 3.0;

inline constexpr double kRoundPx = 0.7;  // px of diameter: two standard deviations of a detected circle's shape

// Returns ln(major / minor) of the circle on the grating's plane, by the grating's lattice. It is 0 for a circle that
// is round and on that plane. Returns 0 for a line grating, which does not determine the plane.
[[nodiscard]] double out_of_round(const DetectedCircle& circle, const DetectedPatch& patch);

// Returns the largest set of circles, each with its nearest grating, that agree in size, polarity, distance and
// extent of the grating. Sizes are measured in pitches of that grating, which removes the perspective. Circles that are
// not round on the grating's plane are excluded. Empty if fewer than two agree.
[[nodiscard]] std::vector<LikeSheet> matching_sheets(std::span<const DetectedCircle> circles,
                                                     std::span<const DetectedPatch> patches);

}  // namespace moiregauge::internal
