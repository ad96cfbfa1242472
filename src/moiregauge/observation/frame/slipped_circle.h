// SPDX-License-Identifier: Apache-2.0
// A reference that slips drags the homography of all circles along, and with it every target.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Five circles that are left have two coordinates to spare.
inline constexpr std::size_t kMinReferencesForSlip = 6;

// Removes the circle that moved on the board since the reference frame, and returns its marker. Returns nothing if there are
// fewer than six circles, if they are where the reference frame has them to 0.5 px rms, or if no single circle explains
// the rest. The site's places do not count: they may be known to millimetres only.
std::optional<std::size_t> remove_slipped(const Reference& reference, std::vector<CirclePoint>& points);

}  // namespace moiregauge::internal
