// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/identity/identify_markers.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/phase/fit/patch_fit.h"

namespace moiregauge::internal {

// Locates the disc of each reference circle near its expected position, without detection. The previous frame identifies
// them in `who`.
// Fails (nothing): a disc is not there (disc_centre). All must then be detected.
// Error: about 0.05 px, which suffices where a grating is read at each circle.
[[nodiscard]] std::optional<CircleSearch> discs_near(const GreyPicture& picture, const Reference& reference,
                                                     const IdealFromBoard& expected, Rows rows, Identified& who);

}  // namespace moiregauge::internal
