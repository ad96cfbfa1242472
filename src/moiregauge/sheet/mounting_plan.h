// SPDX-License-Identifier: Apache-2.0
// The page that goes up the ladder: where every marker hangs, to scale and as a table, and what to mind.
#pragma once

#include "moiregauge/sheet/sheet_set.h"

struct _cairo;  // cairo_t, kept out of our headers

namespace moiregauge::internal::sheet {

[[nodiscard]] Paper plan_paper();  // A4, lying
void draw_mounting_plan(_cairo* cr, const SheetSet& set);

}  // namespace moiregauge::internal::sheet
