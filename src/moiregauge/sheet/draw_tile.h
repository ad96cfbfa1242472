// SPDX-License-Identifier: Apache-2.0
// Draws one part of a sheet that is larger than the paper, with marks for cutting and joining.
//
// Parts are joined from left to right and from top to bottom. A part is cut along the line between its ticks "cut". The
// edge lies on the ticks "join" of the part to its left or above. Both are the same line of the sheet. Corner ticks are
// at one height in a row and at one place in a column. A straight edge along them aligns the parts.
#pragma once

#include "moiregauge/sheet/print_path.h"
#include "moiregauge/sheet/sheet_set.h"

namespace moiregauge::internal::sheet {

// Draws the part in this column and row, counted from 0 at the upper left, on cairo in mm. `sheet`: has a tiling.
void draw_tile(_cairo* cr, const Sheet& sheet, int column, int row, const Ink& ink);

// Returns the upper left corner of a part, mm from that of the sheet's area inside the margins.
[[nodiscard]] PagePoint corner_of_tile(const Tiling& tiling, int column, int row);

}  // namespace moiregauge::internal::sheet
