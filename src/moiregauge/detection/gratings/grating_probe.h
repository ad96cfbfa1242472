// SPDX-License-Identifier: Apache-2.0
// Tests on pixels whether a lattice found in a spectrum is periodic. The power spectrum ignores phases, so noise can
// look like a lattice in it.
#pragma once

#include "moiregauge/detection/gratings/grating_seeds.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Returns the share of the variance of the grey levels that a seed explains by its fundamentals, their sum and their
// difference. Uses pixels within 1.1 periods of the seed's centre. A grating reaches 0.6 (thin lines: 0.4) to 1, rough
// concrete or foliage rarely 0.5. Returns 0 if more than half of the area is outside the image. Takes about 40 us.
[[nodiscard]] double explained_by(const LatticeSeed& seed, const Image<float>& grey);

// Returns the share of the variance of the grey levels that a grid of thin lines explains, within 1.6 periods of the
// seed's centre. The model is a sum of two profiles with three harmonics each, and the product of the fundamentals.
// Returns 0 if a second harmonic is too weak for lines thinner than a third of the pitch. Also returns 0 if the product
// is too strong for crossed lines. Ink-jet lines at a seed of their own pitch reach 0.5 to 0.8.
[[nodiscard]] double explained_by_thin_lines(const LatticeSeed& seed, const Image<float>& grey);

}  // namespace moiregauge::internal
