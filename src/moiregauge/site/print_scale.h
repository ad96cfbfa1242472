// SPDX-License-Identifier: Apache-2.0
// Print scale of a site: printed gratings are larger or smaller than nominal, positions are not.
#pragma once

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Result of measuring the rulers of a sheet: measured divided by nominal length.
struct PrintScale {
  double factor = 1.0;
  double u = 0.0;       // relative standard uncertainty; 0: not stated, the site's own value counts
  double spread = 0.0;  // largest deviation of either axis from the factor, relative
};

// Returns the site with every print `scale.factor` times as large about its grating's centre. This changes pitch,
// grating size, circle diameter and the circle's distance from the grating on the same sheet.
// Positions of gratings were measured at the site and stay, as do those of circles without a grating. The new
// known_to.print_scale is u if that is stated, and never less than the spread.
[[nodiscard]] Site with_prints_scaled(Site site, PrintScale scale);

// Returns the site with its positions scaled about the origin. For sites made from the gratings alone, whose positions
// are counted in pitches.
[[nodiscard]] Site with_places_scaled(Site site, double factor);

// Returns the print scale from one ruler along x and one along y. The instrument uses one scale for both, the mean.
// Half their difference is the spread.
[[nodiscard]] PrintScale mean_of_rulers(double along_x, double along_y);

}  // namespace moiregauge::internal
