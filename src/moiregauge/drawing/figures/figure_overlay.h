// SPDX-License-Identifier: Apache-2.0
// Draws the reference frame with its markers outlined and named, as a figure. Lines and letters are vectors.
#pragma once

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal::figure {

// Returns the figure. It keeps a copy of `picture`, the reference frame, at print resolution. `width` is in points,
// `zoom` that of Figure.
[[nodiscard]] Figure overlay_figure(const Reference& reference, ImageView<std::uint8_t> picture, double width,
                                    double zoom);

}  // namespace moiregauge::internal::figure
