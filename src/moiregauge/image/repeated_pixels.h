// SPDX-License-Identifier: Apache-2.0
// Test for repeated pixels: an image that was enlarged without interpolation.
#pragma once

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Steps on slopes of an image, along its rows or columns.
struct SlopeSteps {
  long all = 0;       // levels with a jump from below and a jump of the same sign above
  long repeated = 0;  // those that two or more successive pixels share, less the jumps of other lines between them
};

// Counts the steps along all rows and columns of a part of an image. A jump is at least `least_jump` grey levels.
// Pixels of one step differ by less than an eighth of that.
[[nodiscard]] SlopeSteps count_slope_steps(const LumaView& part, double least_jump);

}  // namespace moiregauge::internal
