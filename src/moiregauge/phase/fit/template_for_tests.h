// SPDX-License-Identifier: Apache-2.0
// Templates of gratings given by a formula, from the discrete Fourier transform of one period.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "moiregauge/phase/fit/print_template.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::testing {

// Returns the template of level(x, y), with x and y in pitches. It contains harmonics up to `order` and no mean.
template <typename Level>
PrintTemplate template_of(int order, const Level& level) {
  constexpr int kSide = 64;
  using Complex = std::complex<double>;
  const int wide = 2 * order + 1;
  std::vector<Complex> series(static_cast<std::size_t>(wide * wide));
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double x = double(i) / kSide, y = double(j) / kSide, grey = level(x, y) / (kSide * kSide);
      for (int n = -order; n <= order; ++n) {
        for (int m = -order; m <= order; ++m)
          series[static_cast<std::size_t>((n + order) * wide + m + order)] +=
              grey * std::polar(1.0, -kTwoPi * (m * x + n * y));
      }
    }
  }
  return {order, series};
}

}  // namespace moiregauge::internal::testing
