// SPDX-License-Identifier: Apache-2.0
// Is what a spectrum takes for a lattice really periodic? Asked of the pixels themselves.
#pragma once

#include "moiregauge/detection/gratings/grating_seeds.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Share of the grey levels' variance, within 1.1 periods each way of the seed, that its fundamentals and their sums and
// differences explain. Of a print 0.6 (thin lines: 0.4) to 1; of rough concrete or foliage, whose spectra may look as
// pure, hardly ever 0.5. Takes about 40 us.
[[nodiscard]] double explained_by(const LatticeSeed& seed, const Image<float>& grey);

// Returns the share of the grey levels' variance, within 1.6 periods each way of the seed, that a grid of thin lines
// explains (a sum of two profiles, each of three harmonics, and their first product). Returns 0 where either second
// harmonic is too weak for lines thinner than a third of the pitch, or the product too strong for crossed lines.
// Ink-jet lines at a seed of their own pitch reach 0.5 to 0.8.
[[nodiscard]] double explained_by_thin_lines(const LatticeSeed& seed, const Image<float>& grey);

}  // namespace moiregauge::internal
