// SPDX-License-Identifier: Apache-2.0
// How the points of a series are shown.
#pragma once

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

enum class Mark { kLine, kDashed, kDots, kOpenDots, kSquares, kOpenSquares, kCrosses };

[[nodiscard]] bool joins_points(Mark mark);
// One point, `radius` from its centre to its rim; nothing where `at` is no finite number. Not for marks that join
// points.
void draw_mark(Canvas& canvas, Mark mark, Spot at, double radius, Colour colour);

}  // namespace moiregauge::internal::figure
