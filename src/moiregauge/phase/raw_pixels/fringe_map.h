// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "moiregauge/geometry/homography.h"

namespace moiregauge::internal {

namespace frame {
struct Fringe;  // (X, Y): position in a grating from the middle of a window, periods along both raster axes
}

using FringePoint = Point<frame::Fringe>;

// Map from image pixels to periods of a grating. A lens bends it within the window by a biquadratic correction.
struct FringeMap {
  Homography<frame::Fringe, frame::Image> from_image;
  bool is_bent = false;
  double half = 1.0;  // half the side of the bent window, periods
  // Corrections of X and Y, periods: coefficients of x^i y^j, i fastest, with x = X / half and y = Y / half.
  std::array<std::array<double, 9>, 2> bend{};
};

}  // namespace moiregauge::internal
