// SPDX-License-Identifier: Apache-2.0
// Draws the mounting plan: the position of every marker, to scale and as a table, with instructions.
#pragma once

#include "moiregauge/sheet/sheet_set.h"

struct _cairo;  // cairo_t, without cairo's header

namespace moiregauge::internal::sheet {

[[nodiscard]] Paper plan_paper();  // A4, landscape
void draw_mounting_plan(_cairo* cr, const SheetSet& set);

}  // namespace moiregauge::internal::sheet
