// SPDX-License-Identifier: Apache-2.0
// Measures the sharpening inside a camera, which draws a bright seam along dark edges and a dark one along bright
// edges.
#pragma once

#include "moiregauge/observation/print/print_model.h"

namespace moiregauge::internal {

// Returns the excess of a template beyond its own plateaus, as a share of their difference. The plateaus are the
// lightest and the darkest of its symmetry points. The excess is about 0 after blur by lens and pixel, whose edges are
// monotone. It is 0, too, if the template has no symmetry.
[[nodiscard]] double overshoot_of(const PrintModel& print);

}  // namespace moiregauge::internal
