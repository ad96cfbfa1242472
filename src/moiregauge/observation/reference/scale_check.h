// SPDX-License-Identifier: Apache-2.0
// One length of a run that a tape can check. A wrong pitch makes every millimetre wrong, and no picture shows it.
#pragma once

#include <string>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

struct ScaleCheck {
  double mm_per_px = 0.0;  // in the middle of the references, in the reference frame
  std::size_t from = 0;    // index in the site
  std::size_t to = 0;      // the same as `from` where one marker is all there is: then the length is its print's width
  double distance_mm = 0.0;  // from centre to centre, of their circles or else of their prints
};

// Returns the scale in the reference frame, with the first two references (in the site's order) that are nearly as far
// apart as any two. Fewer than two references: any two markers.
[[nodiscard]] ScaleCheck scale_check(const Reference& reference);

// Returns "256 mm", "12.5 mm": three digits, or all before the point.
[[nodiscard]] std::string short_length(double length, const char* unit);

// Returns "R1 to R2: 256 mm", or "print of T1: 60.0 mm wide". `unit_mm` is the length on the board of one unit.
[[nodiscard]] std::string tape_text(const ScaleCheck& check, const Site& site, double unit_mm, const char* unit);

}  // namespace moiregauge::internal
