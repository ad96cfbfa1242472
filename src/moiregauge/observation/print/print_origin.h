// SPDX-License-Identifier: Apache-2.0
// Finds a print's own symmetry point. A template learned through the reference frame's view has its origin where that
// view puts `grating_mm`: off by what the lens does to the circles. The print itself shows the point that the site means.
#pragma once

#include <optional>

#include "moiregauge/phase/fit/patch_pass.h"
#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

struct PrintOrigin {
  PrintPoint at;         // of the nearest symmetry point, in the template's coordinates, pitches
  double spacing = 0.0;  // pitches, to the next symmetry point
  double u = 0.0;        // standard uncertainty of either coordinate, from what of the print is not symmetric about it
};

// Returns the symmetry point nearest to a template's origin: where dark lines cross or light ones do, the centre of a dot
// or square, a corner or centre of a checkerboard's square. Uses only the axes that the print shows. Returns nothing where
// the print is not symmetric (more than 1 % of its power is odd about every such point).
[[nodiscard]] std::optional<PrintOrigin> nearest_symmetry(const PrintTemplate& print, bool along_x, bool along_y);

// Returns the same print with its origin moved to `origin`.
[[nodiscard]] PrintTemplate with_origin(const PrintTemplate& print, PrintPoint origin);

}  // namespace moiregauge::internal
