// SPDX-License-Identifier: Apache-2.0
// Determines the board's millimetres from gratings of known pitch alone.
#pragma once

#include <span>

#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

using BoardFromIdeal = Homography<frame::Board, frame::Ideal>;

// Returns the map under which every grating repeats by its pitch along both axes, at right angles. Its x is nearest to
// the image's horizontal and y is up. Rotation and origin are arbitrary (see `turned`). `patches` must not be empty.
[[nodiscard]] BoardFromIdeal board_from_gratings(std::span<const DetectedPatch> patches, const Camera& lens,
                                                 double pitch_mm);

// Returns the direction of a grating's x on the board, rad, within 45 degrees of the board's x.
[[nodiscard]] double print_angle(const DetectedPatch& patch, const BoardFromIdeal& board, const Camera& lens);

// Returns the grating's pitch on the board, mm: the mean over the axes that it shows.
[[nodiscard]] double pitch_on(const DetectedPatch& patch, const BoardFromIdeal& board, const Camera& lens);

// Returns the same map after a rotation by -angle about `origin`, which becomes (0, 0).
[[nodiscard]] BoardFromIdeal turned(const BoardFromIdeal& board, double angle_rad, BoardPoint origin);

}  // namespace moiregauge::internal
