// SPDX-License-Identifier: Apache-2.0
// Length of a run that a tape measure can check. A wrong pitch makes every millimetre wrong, and no image shows that.
#pragma once

#include <string>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

struct ScaleCheck {
  double mm_per_px = 0.0;  // in the middle of the references, in the reference frame
  std::size_t from = 0;    // index in the site
  // Index in the site. It equals `from` if there is one marker only. The length is then the width of its grating.
  std::size_t to = 0;
  double distance_mm = 0.0;  // between the centres of their circles, or else of their gratings
};

// Returns the scale in the reference frame and a distance to check. This is the distance of the first two references,
// in the site's order, that are at least 0.7 of the largest distance apart. With fewer than two references, any two
// markers serve.
[[nodiscard]] ScaleCheck scale_check(const Reference& reference);

// Returns a length with three digits, or with all digits before the point: "256 mm", "12.5 mm".
[[nodiscard]] std::string short_length(double length, const char* unit);

// Returns the distance as text, for example `R1 to R2 = 256 mm` or `grating of T1 = 60.0 mm wide`. `unit_mm` is the
// length on the board of one unit, mm.
[[nodiscard]] std::string tape_text(const ScaleCheck& check, const Site& site, double unit_mm, const char* unit);

}  // namespace moiregauge::internal
