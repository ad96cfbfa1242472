// SPDX-License-Identifier: Apache-2.0
// Apparent size: gratings that look larger or smaller than pitch and height state.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// Returns one line per marker whose apparent size differs from the site's. The limit is four u of the site, or 1 % for
// a target of unknown height.
// Apparent size cannot separate pitch from distance, so the line states both as lengths. Markers whose distance follows
// from parallax have no line.
// `calibration`: with the fits of its key frames.
[[nodiscard]] std::vector<std::string> apparent_size_notes(const Site& site, const Calibration& calibration);

}  // namespace moiregauge::internal
