// SPDX-License-Identifier: Apache-2.0
// Describes detected objects in short texts, the same in the overlay and on the terminal.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/displacement/expected_uncertainty.h"
#include "moiregauge/observation/views/inspection.h"

namespace moiregauge::internal {

// Returns the rejected outlines that are not part of a grating, a lattice or an accepted circle. Highest circularity
// first.
[[nodiscard]] std::vector<const RejectedOutline*> rejected_elsewhere(const Inspection& seen);

[[nodiscard]] std::string name_of(const Inspection& seen, int marker);      // "-": not identified
[[nodiscard]] std::string pattern_text(const DetectedPatch& patch);         // "crossed, dark on light"
[[nodiscard]] std::string pitch_text(const DetectedPatch& patch);           // "pitch 29.0 x 28.9 px, x at +0.3 deg"
[[nodiscard]] std::string lattice_text(const IndexedLattice& lattice);      // "dots 10 x 10, 100 of 100"
[[nodiscard]] std::string both_axes(double x, double y, const char* unit);  // "0.01 px along x, 0.02 px along y"
[[nodiscard]] std::string expected_text(const Inspection& seen, const ExpectedUncertainty& expected);

}  // namespace moiregauge::internal
