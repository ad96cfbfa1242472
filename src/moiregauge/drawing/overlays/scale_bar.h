// SPDX-License-Identifier: Apache-2.0
// Draws a scale bar in a free corner of the overlays.
#pragma once

#include <string>

#include "moiregauge/drawing/overlays/overlay_pen.h"
#include "moiregauge/observation/reference/scale_check.h"

namespace moiregauge::internal {

// Returns the largest of 1, 2 and 5 times a power of ten that is not above `length`.
[[nodiscard]] double round_length(double length);

// Draws a bar that is correct at the centre of the references, with its length and `tape_text`.
// `unit_mm`: length of one `unit` ("mm", "pitches") on the board, mm. `picture`: the allowed area, page px.
void draw_scale_bar(overlay::Pen& pen, const Reference& reference, double unit_mm, const char* unit,
                    const overlay::Box& picture);

}  // namespace moiregauge::internal
