// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/plots/marks.h"

#include <cmath>

namespace moiregauge::internal::figure {

bool joins_points(Mark mark) { return mark == Mark::kLine || mark == Mark::kDashed; }

void draw_mark(Canvas& canvas, Mark mark, Spot at, double radius, Colour colour) {
  if (!std::isfinite(at.x) || !std::isfinite(at.y)) return;
  const Stroke thin{colour, 0.7};
  const Box square{at.x - radius, at.y - radius, 2.0 * radius, 2.0 * radius};
  switch (mark) {
    case Mark::kLine:
    case Mark::kDashed:
      return;
    case Mark::kDots:
      return canvas.dot(at, radius, colour);
    case Mark::kOpenDots:
      return canvas.ellipse(at, radius, radius, 0.0, thin);
    case Mark::kSquares:
      return canvas.fill(square, colour);
    case Mark::kOpenSquares:
      return canvas.frame(square, thin);
    case Mark::kCrosses:
      canvas.line({{at.x - radius, at.y - radius}, {at.x + radius, at.y + radius}}, thin);
      return canvas.line({{at.x - radius, at.y + radius}, {at.x + radius, at.y - radius}}, thin);
  }
}

}  // namespace moiregauge::internal::figure
