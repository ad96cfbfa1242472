// SPDX-License-Identifier: Apache-2.0
// Sums over the pixels of a window, on every SIMD target with the same bits, because all sums are integers.
#pragma once

#include <cstdint>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Radii of three nested circles about one centre, px.
struct DiscRadii {
  double window = 0.0, ring = 0.0, middle = 0.0;
};

// Sums over the pixels inside these circles. x and y count from (x0, y0), the window's first pixel.
struct DiscSums {
  std::int64_t pixels = 0, x = 0, y = 0, grey = 0, grey_x = 0, grey_y = 0;  // inside the window
  std::int64_t ring_pixels = 0, ring_grey = 0;
  std::int64_t middle_pixels = 0, middle_grey = 0;
  int x0 = 0, y0 = 0;
};

// Sums every row_step-th row of a disc's window about `at`. The window must be inside the image.
[[nodiscard]] DiscSums sum_disc(const LumaView& luma, ImagePoint at, const DiscRadii& radii, int row_step);

// Returns the number of pixels that are black (0) or at least `white`.
[[nodiscard]] long count_clipped(const LumaView& luma, int white);

}  // namespace moiregauge::internal
