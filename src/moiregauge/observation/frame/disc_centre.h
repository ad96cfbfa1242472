// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Locates a printed disc that was seen before as `like`, within a fifth of its diameter of `expected`. The result is
// the centroid of each pixel's contrast to the paper, px. With Rows::kSome every second row of a disc of 40 px or more
// is read.
// Fails (nothing): there is no whole disc of this size and contrast with paper around it. It must then be detected.
// Error: about 0.05 px.
[[nodiscard]] std::optional<ImagePoint> disc_centre(const LumaView& luma, ImagePoint expected, double diameter_px,
                                                    const DetectedCircle& like, Rows rows = Rows::kAll);

}  // namespace moiregauge::internal
