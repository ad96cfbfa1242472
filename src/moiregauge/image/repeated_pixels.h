// SPDX-License-Identifier: Apache-2.0
// Pixels that were written more than once: a picture that was enlarged without interpolation.
#pragma once

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Steps on slopes of a picture, along its rows or its columns.
struct SlopeSteps {
  long all = 0;       // levels with a jump from below and a jump of the same sign above
  long repeated = 0;  // those that two or more pixels in a row have
};

// Counts the steps along all rows and all columns of a part of a picture. A jump is at least `least_jump` grey levels,
// and pixels of one step differ by less than an eighth of that.
[[nodiscard]] SlopeSteps count_slope_steps(const LumaView& part, double least_jump);

// Returns that part of a picture; it is cut to the picture.
[[nodiscard]] LumaView part_of(const LumaView& luma, int x0, int y0, int x1, int y1);

}  // namespace moiregauge::internal
