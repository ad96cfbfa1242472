// SPDX-License-Identifier: Apache-2.0
// Sub-pixel centre of a disc: least squares fit to the grey levels in a band around its edge.
//
// Model: the lighter side is a plane of grey levels (shading). The darker side is the same plane times 1 - q, because
// ink reflects a fixed share of the light. The transition is an error function of the distance from the ellipse, of
// width sigma (blur of lens and pixel). The model is symmetric about the centre, so its own errors do not move the
// centre.
#pragma once

#include <optional>

#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/detection/circles/traced_outline.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct FittedDisc {
  Ellipse ellipse;
  double u_centre_px = 0.0;  // px, standard uncertainty (k = 1) of each coordinate, from the residual of the fit
  double residual = 0.0;     // grey levels, rms
  double blur_px = 0.0;      // px, sigma of the edge
};

// Fits the disc model, starting from the traced outline. Empty if the fit diverges, has too few pixels or moves more
// than 0.5 px from the traced centre.
[[nodiscard]] std::optional<FittedDisc> fit_disc(const LumaView& luma, const TracedOutline& outline);

}  // namespace moiregauge::internal::markers_detail
