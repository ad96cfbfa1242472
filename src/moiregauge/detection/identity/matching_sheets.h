// SPDX-License-Identifier: Apache-2.0
// Circles that stand beside a grating of their own, all in the same way: sheets printed from one template. A look-alike
// circle has no grating beside it, or stands to one as no other does.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/gratings/grating_patches.h"

namespace moiregauge::internal {

struct LikeSheet {
  std::size_t circle = 0;
  std::size_t patch = 0;
};

// How far a grating's edge may be from the circle it belongs to, in diameters of the circle.
inline constexpr double kGratingReach = 3.0;

inline constexpr double kRoundPx = 0.7;  // px of diameter: two spreads of a seen circle's shape

// ln(major / minor) of the circle on the grating's plane, as the grating's lattice shows it: 0 where the circle is
// round and on that plane. Of lines, which do not show the plane, 0.
[[nodiscard]] double out_of_round(const DetectedCircle& circle, const DetectedPatch& patch);

// The largest set of circles, each with the grating nearest to it, that agree in the circle's size and contrast and in
// the grating's extent and distance, all counted in pitches of that grating, which takes the view out. Only circles
// that are round where the grating's lattice is square lie on its plane. Fewer than two that agree are no set: empty.
[[nodiscard]] std::vector<LikeSheet> matching_sheets(std::span<const DetectedCircle> circles,
                                                     std::span<const DetectedPatch> patches);

}  // namespace moiregauge::internal
