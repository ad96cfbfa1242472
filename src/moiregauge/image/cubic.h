// SPDX-License-Identifier: Apache-2.0
// Grey levels between the pixels.
#pragma once

#include <cmath>

#include "moiregauge/image/image.h"

namespace moiregauge {

// Cubic convolution, a = -1/2 (R. Keys 1981, doi:10.1109/TASSP.1981.1163711). The seed paper interpolates linearly;
// that damps the fringe by up to omega^2 / 8 between pixels, a ripple which beats with an oblique pixel grid and costs
// 0.002 px at 20 deg. Cubic damping is of order omega^4.
struct CubicWeights {
  double w[4];
  explicit CubicWeights(double t)
      : w{((-0.5 * t + 1.0) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1.0, ((-1.5 * t + 2.0) * t + 0.5) * t,
          (0.5 * t - 0.5) * t * t} {}
};

// The grey level at (x, y) px; false, and `grey` untouched, where the picture does not hold all 4 x 4 pixels round it.
template <typename Grey>
[[nodiscard]] bool cubic_at(const ImageView<Grey>& picture, double x, double y, double& grey) {
  if (!(x >= 1.0 && y >= 1.0 && x < picture.width - 2.0 && y < picture.height - 2.0)) return false;  // nor a NaN
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const CubicWeights across(x - x0), down(y - y0);
  double sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    const Grey* p = picture.data + (y0 + j - 1) * picture.stride + x0 - 1;
    sum += down.w[j] * (across.w[0] * p[0] + across.w[1] * p[1] + across.w[2] * p[2] + across.w[3] * p[3]);
  }
  grey = sum;
  return true;
}

}  // namespace moiregauge
