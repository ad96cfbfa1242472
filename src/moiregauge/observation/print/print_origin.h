// SPDX-License-Identifier: Apache-2.0
// Finds a grating's own symmetry point (docs/methods/precise/template.md). A template learned through the reference
// frame's view has its origin where that view has `grating_mm`. The lens displaces this origin, because it acts on the
// circles. The grating itself shows the point that the site states.
#pragma once

#include <optional>

#include "moiregauge/phase/fit/patch_pass.h"
#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

struct PrintOrigin {
  PrintPoint at;         // nearest symmetry point in the template's coordinates, pitches
  double spacing = 0.0;  // pitches, to the next symmetry point
  // Standard uncertainty (k = 1) of either coordinate, from the part of the grating that is not symmetric about the
  // point.
  double u = 0.0;
};

// Returns the symmetry point nearest to a template's origin, from the axes that the grating shows. It is a crossing of
// dark or of light lines, the centre of a dot or square, or a corner of a checkerboard.
// Fails (nothing): the grating is not symmetric, because 1 % or more of its power is odd about that point.
// Error: `u` of the result.
[[nodiscard]] std::optional<PrintOrigin> nearest_symmetry(const PrintSeries& print, bool along_x, bool along_y);

// Returns the same series with its origin moved to `origin`.
[[nodiscard]] PrintSeries with_origin(const PrintSeries& print, PrintPoint origin);

}  // namespace moiregauge::internal
