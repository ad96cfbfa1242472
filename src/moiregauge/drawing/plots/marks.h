// SPDX-License-Identifier: Apache-2.0
// Draws the points of a series.
#pragma once

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

enum class Mark { kLine, kDashed, kDots, kOpenDots, kSquares, kOpenSquares, kCrosses };

[[nodiscard]] bool joins_points(Mark mark);
// Draws one point. `radius` is the distance from centre to rim. Draws nothing if `at` is not finite. Not for marks that
// join points.
void draw_mark(Canvas& canvas, Mark mark, Spot at, double radius, Colour colour);

}  // namespace moiregauge::internal::figure
