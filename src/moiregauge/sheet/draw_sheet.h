// SPDX-License-Identifier: Apache-2.0
// One sheet: its markers, rulers of 100 mm along both edges, cutting marks, and in words what it is and how to print
// it.
#pragma once

#include <string>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/sheet/print_path.h"
#include "moiregauge/sheet/sheet_set.h"

namespace moiregauge::internal::sheet {

// On cairo in millimetres, y downwards, the page's upper left corner at (0, 0).
void draw_sheet(_cairo* cr, const Sheet& sheet, const Ink& ink);

// The letters, smaller where the words are longer than `width`.
[[nodiscard]] figure::Letters fitted(figure::Canvas& canvas, const std::string& words, figure::Letters letters,
                                     double width);

// 100 mm; on paper with less room as many whole centimetres as there are.
[[nodiscard]] double ruler_mm(double room_mm);

// "10 mm crossed lines"; of prints that differ all of them.
[[nodiscard]] std::string words_for_prints(const std::vector<Marker>& markers);

}  // namespace moiregauge::internal::sheet
