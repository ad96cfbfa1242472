// SPDX-License-Identifier: Apache-2.0
// Sharpening inside a camera draws a bright seam along dark edges and a dark one along bright edges.
#pragma once

#include "moiregauge/observation/print/print_model.h"

namespace moiregauge::internal {

// Returns by how much a print's template exceeds its own plateaus, as a share of their difference. The plateaus are the
// lightest and the darkest of its symmetry points. About 0 for a print blurred by lens and pixel, whose edges are monotone;
// 0 too if the template has no symmetry.
[[nodiscard]] double overshoot_of(const PrintModel& print);

}  // namespace moiregauge::internal
