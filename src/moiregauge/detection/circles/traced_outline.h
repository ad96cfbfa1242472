// SPDX-License-Identifier: Apache-2.0
// The sub-pixel outline of one candidate: along rays from its centre, the place where the grey level is half-way
// between inside and outside. Judges roundness; the final centre is disc_fit.h's.
#pragma once

#include <string>

#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct TracedOutline {
  Ellipse ellipse;
  double circularity = 0.0;  // W = 4 pi S / L^2 of the sub-pixel outline; 1 for a circle
  double residual_px = 0.0;  // rms distance from the ellipse
  double contrast = 0.0;     // grey levels, inside minus outside
  double background = 0.0;   // grey level just outside
  double blur_px = 0.0;      // sigma of the edge taken as an error function
  std::string problem;       // empty: traced all round
};

[[nodiscard]] TracedOutline trace_outline(const LumaView& luma, const Ellipse& start);

}  // namespace moiregauge::internal::markers_detail
