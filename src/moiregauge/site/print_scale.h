// SPDX-License-Identifier: Apache-2.0
// What a printer's stretch does to a site: prints are larger than nominal, places are not.
#pragma once

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// What the rulers of a sheet showed: measured over nominal length.
struct PrintScale {
  double factor = 1.0;
  double u = 0.0;       // relative standard uncertainty; 0: not stated, the site's own word stands
  double spread = 0.0;  // by how much either axis may differ from the factor, relative
};

// The site with every print `scale.factor` times as large about its grating's centre: pitch, size of the grating,
// diameter of the circle and its distance from the grating, which is on the same sheet. Where the gratings hang was
// measured at the site and stays; so does where a circle without a grating hangs. known_to.print_scale becomes u where
// that is stated, and is never less than the spread.
[[nodiscard]] Site with_prints_scaled(Site site, PrintScale scale);

// Of a site that was made from the prints alone: its places are counted in pitches, so they grow too, about the origin.
[[nodiscard]] Site with_places_scaled(Site site, double factor);

// A ruler along x and one along y. The instrument takes one scale for both: the mean; half their difference is the
// spread.
[[nodiscard]] PrintScale mean_of_rulers(double along_x, double along_y);

}  // namespace moiregauge::internal
