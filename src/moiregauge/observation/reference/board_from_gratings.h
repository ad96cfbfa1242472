// SPDX-License-Identifier: Apache-2.0
// The board's millimetres from nothing but gratings of known pitch.
#pragma once

#include <span>

#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

using BoardFromIdeal = Homography<frame::Board, frame::Ideal>;

// The map under which every grating repeats by its pitch along both axes, at right angles; x nearest to the picture's
// horizontal, y up, turned and placed anyhow (`turned` does that). `patches` must not be empty.
[[nodiscard]] BoardFromIdeal board_from_gratings(std::span<const DetectedPatch> patches, const Camera& lens,
                                                 double pitch_mm);

// Direction of a grating's x on the board, in (-45, 45] degrees about the board's x.
[[nodiscard]] double print_angle(const DetectedPatch& patch, const BoardFromIdeal& board, const Camera& lens);

// The grating's pitch on the board, mm: mean over the axes that it shows.
[[nodiscard]] double pitch_on(const DetectedPatch& patch, const BoardFromIdeal& board, const Camera& lens);

// The same map after a turn by -angle about `origin`, which becomes (0, 0).
[[nodiscard]] BoardFromIdeal turned(const BoardFromIdeal& board, double angle_rad, BoardPoint origin);

}  // namespace moiregauge::internal
