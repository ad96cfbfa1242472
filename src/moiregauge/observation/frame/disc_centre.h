// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Where a printed disc stands that was seen before as `like` and is expected within a fifth of its diameter of
// `expected`: the centroid of how much darker (or lighter) than its paper every pixel is, to about 0.05 px. Nothing
// where there is no such disc, whole, with paper round it: then one has to look properly. Of a large disc every second row
// tells the centre nearly as well.
[[nodiscard]] std::optional<ImagePoint> disc_centre(const LumaView& luma, ImagePoint expected, double diameter_px,
                                                    const DetectedCircle& like, Rows rows = Rows::kAll);

}  // namespace moiregauge::internal
