// SPDX-License-Identifier: Apache-2.0
// The reference frame with its markers outlined and named, as a figure: lines and letters are vectors.
#pragma once

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal::figure {

// `picture`: the reference frame, kept as a copy no finer than the page can show. width in points; zoom as Figure's.
[[nodiscard]] Figure overlay_figure(const Reference& reference, ImageView<std::uint8_t> picture, double width,
                                    double zoom);

}  // namespace moiregauge::internal::figure
