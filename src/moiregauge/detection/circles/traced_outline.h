// SPDX-License-Identifier: Apache-2.0
// Sub-pixel outline of one candidate: on each ray from its centre, the point where the grey level crosses the mid-level
// between inside and outside. The outline serves to test the roundness. disc_fit.h gives the final centre.
#pragma once

#include <string>

#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct TracedOutline {
  Ellipse ellipse;
  double circularity = 0.0;  // W = 4 pi S / L^2 of the sub-pixel outline; 1 for a circle
  double residual_px = 0.0;  // px, rms distance from the ellipse
  double contrast = 0.0;     // grey levels, inside minus outside
  double background = 0.0;   // grey level just outside
  double blur_px = 0.0;      // px, sigma of the edge as an error function
  std::string problem;       // reason for failure; empty for a closed outline
};

// Traces the outline in up to seven rounds, starting from an approximate ellipse. A failure is reported in `problem`.

[[nodiscard]] TracedOutline trace_outline(const LumaView& luma, const Ellipse& start);

}  // namespace moiregauge::internal::markers_detail
