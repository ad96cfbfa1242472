// SPDX-License-Identifier: Apache-2.0
// A reference that slips drags the homography of all circles along, and with it every target.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "moiregauge/observation/reference.h"

namespace moiregauge {

// Five circles that are left have two coordinates to spare.
inline constexpr std::size_t kMinReferencesForSlip = 6;

// Removes the circle that alone contradicts all others, and returns its marker. Returns nothing if there are fewer than
// six circles, if they fit one homography to 0.5 px rms, or if no single circle explains what they do not fit.
std::optional<std::size_t> remove_slipped(std::vector<CirclePoint>& points);

}  // namespace moiregauge
