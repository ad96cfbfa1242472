// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/texture.h"

#include <cmath>

#include "moiregauge/simulator/scenario/gaussian.h"

namespace moiregauge::internal::simulator {
namespace {

// Returns uniform random numbers (-0.5 to 0.5) at the knots of a square grid, smoothly interpolated. The rms is 0.21.
double value_noise(std::uint64_t seed, double x, double y) {
  const double x0 = std::floor(x), y0 = std::floor(y), u = x - x0, v = y - y0;
  const auto knot = [&](double kx, double ky) {
    const auto ix = static_cast<std::uint64_t>(static_cast<std::int64_t>(kx));
    const auto iy = static_cast<std::uint64_t>(static_cast<std::int64_t>(ky));
    return hashed_unit(seed, ix * 0x100000001b3U + iy) - 0.5;
  };
  const double su = u * u * (3.0 - 2.0 * u), sv = v * v * (3.0 - 2.0 * v);
  const double low = knot(x0, y0) + su * (knot(x0 + 1, y0) - knot(x0, y0));
  const double high = knot(x0, y0 + 1) + su * (knot(x0 + 1, y0 + 1) - knot(x0, y0 + 1));
  return low + sv * (high - low);
}

}  // namespace

double roughness(std::uint64_t seed, double x_mm, double y_mm) {
  return 3.0 * value_noise(seed, x_mm / 40.0, y_mm / 40.0) + 2.5 * value_noise(seed + 1, x_mm / 9.0, y_mm / 9.0) +
         2.5 * value_noise(seed + 2, x_mm / 2.0, y_mm / 2.0);
}

// A uniform draw of +-1/2 at the knots has the variance 1/12. The interpolation weights have a mean square of 26/35
// along each axis, so the variance is 1/12 * (26/35)^2.
double grain(std::uint64_t seed, double x, double y) {
  constexpr double kRms = 0.28867513459481287 * 26.0 / 35.0;
  return value_noise(seed, x, y) / kRms;
}

}  // namespace moiregauge::internal::simulator
