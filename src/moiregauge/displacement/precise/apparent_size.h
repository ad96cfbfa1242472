// SPDX-License-Identifier: Apache-2.0
// Prints that look larger or smaller than pitch and height say.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// Returns one line per marker whose print looks of another size than the site says: by more than four of the site's own
// u, or, of a target of unknown height, by more than a hundredth. Apparent size alone cannot separate a print of another
// pitch from one at another distance, so both are named, as lengths: "target 'mid' looks 4.3 % larger than ...". No line
// for a marker whose distance follows from parallax.
// calibration  with the fits of its key frames
[[nodiscard]] std::vector<std::string> apparent_size_notes(const Site& site, const Calibration& calibration);

}  // namespace moiregauge::internal
