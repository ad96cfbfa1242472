// SPDX-License-Identifier: Apache-2.0
// Finds a slipped reference, which displaces the homography of all circles and with it every target.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// The five that remain have two redundant coordinates.
inline constexpr std::size_t kMinReferencesForSlip = 6;

// Removes the circle that moved on the board since the reference frame, and returns its marker. Positions of the site
// do not count, because they may be known to millimetres only. Returns nothing if there are fewer than six circles, or
// if all agree with the reference frame to 0.5 px rms. Returns nothing, too, if no single circle explains the
// deviation.
std::optional<std::size_t> remove_slipped(const Reference& reference, std::vector<CirclePoint>& points);

}  // namespace moiregauge::internal
