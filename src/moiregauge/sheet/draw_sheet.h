// SPDX-License-Identifier: Apache-2.0
// Draws one sheet: its markers, rulers of 100 mm along both edges, cutting marks, and a text on its content and
// printing.
#pragma once

#include <string>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/sheet/print_path.h"
#include "moiregauge/sheet/sheet_set.h"

namespace moiregauge::internal::sheet {

// Draws on cairo in mm. y is downwards, and (0, 0) is the page's upper left corner.
void draw_sheet(_cairo* cr, const Sheet& sheet, const Ink& ink);

// Draw parts of a sheet: its markers with their cutting marks, the rulers along the left and lower edges, the arrow, the
// texts below.
void draw_markers(_cairo* cr, const Sheet& sheet, const Ink& ink);
void draw_rulers(_cairo* cr, const Paper& paper);
void draw_up_arrow(_cairo* cr, double x_mm, double y_mm);
void draw_instructions(_cairo* cr, const Paper& paper);
// Returns "reference: must not move", or how many markers of each role there are.
[[nodiscard]] std::string role_of(const Sheet& sheet);

// Returns the letters, smaller if the text is longer than `width`.
[[nodiscard]] figure::Letters fitted(figure::Canvas& canvas, const std::string& words, figure::Letters letters,
                                     double width);

// Returns 100 mm, or fewer whole centimetres on smaller paper.
[[nodiscard]] double ruler_mm(double room_mm);

// Returns "pitch 10 mm, grid". Lists all gratings that differ.
[[nodiscard]] std::string words_for_prints(const std::vector<Marker>& markers);

}  // namespace moiregauge::internal::sheet
