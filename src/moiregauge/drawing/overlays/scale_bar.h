// SPDX-License-Identifier: Apache-2.0
// A scale bar for the overlays, in a corner of the picture that is free.
#pragma once

#include <string>

#include "moiregauge/drawing/overlays/overlay_pen.h"
#include "moiregauge/observation/reference/scale_check.h"

namespace moiregauge::internal {

// Returns the largest of 1, 2 and 5 times a power of ten that is not over `length`.
[[nodiscard]] double round_length(double length);

// Draws a bar that is right in the middle of the references, with its length and `tape_text` next to it.
// `unit_mm`: what a length on the board is counted in ("mm", "pitches"). `picture`: where it may go, page px.
void draw_scale_bar(overlay::Pen& pen, const Reference& reference, double unit_mm, const char* unit,
                    const overlay::Box& picture);

}  // namespace moiregauge::internal
