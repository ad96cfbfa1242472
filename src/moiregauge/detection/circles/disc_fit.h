// SPDX-License-Identifier: Apache-2.0
// The sub-pixel centre of a disc: least squares of the grey levels in the band round its edge.
//
// Model: the lighter side is a plane of grey (shading), the darker side the same plane times 1 - q (paint reflects a
// share of the light that falls on it), and between the two an error function of the distance from the ellipse, of
// width sigma (lens and pixel). Symmetric about the centre, so errors of the model itself do not move it.
#pragma once

#include <optional>

#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/detection/circles/traced_outline.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct FittedDisc {
  Ellipse ellipse;
  double u_centre_px = 0.0;  // standard uncertainty of each coordinate, from the fit's own residual
  double residual = 0.0;     // grey levels, rms
  double blur_px = 0.0;
};

// Empty when the fit runs away from the traced outline.
[[nodiscard]] std::optional<FittedDisc> fit_disc(const LumaView& luma, const TracedOutline& outline);

}  // namespace moiregauge::internal::markers_detail
