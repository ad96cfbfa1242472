// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/planned_print.h"

#include <cmath>
#include <complex>
#include <vector>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(kPi * x) / (kPi * x); }

// Returns the Fourier coefficient of lines that are half a pitch wide and dark about 0. The mean is 1/2.
double bar(int m) { return m == 0 ? 0.5 : std::sin(0.5 * kPi * m) / (kPi * m); }
double gap(int m) { return m == 0 ? 0.5 : -bar(m); }

// Returns the Fourier coefficient of a disc with a radius of a quarter pitch (its transform is a Bessel function).
double disc(int m, int n) {
  constexpr double kRadius = 0.25;
  const double q = std::hypot(m, n);
  return q == 0.0 ? kPi * kRadius * kRadius : kRadius * std::cyl_bessel_j(1.0, kTwoPi * kRadius * q) / q;
}

// Returns the Fourier coefficient of the share of paper (light).
double paper(Pattern pattern, int m, int n) {
  switch (pattern) {
    case Pattern::kSquares:
      return -bar(m) * bar(n);
    case Pattern::kDots:
      return -disc(m, n);
    case Pattern::kLinesX:
      return n == 0 ? -bar(m) : 0.0;
    case Pattern::kLinesY:
      return m == 0 ? -bar(n) : 0.0;
    case Pattern::kCheckerboard:
      return -bar(m) * bar(n) - gap(m) * gap(n);
    case Pattern::kCosine:
      return std::abs(m) + std::abs(n) == 1 ? 0.125 : 0.0;
    default:
      return gap(m) * gap(n);
  }
}

}  // namespace

PrintTemplate planned_print(Pattern pattern, double pitch_px, const PlannedOptics& optics) {
  const int order = highest_order(pitch_px);
  std::vector<std::complex<double>> series;
  const double blur = 2.0 * std::pow(kPi * optics.psf_sigma_px / pitch_px, 2);
  for (int n = -order; n <= order; ++n) {
    for (int m = -order; m <= order; ++m) {
      const double x = m / pitch_px, y = n / pitch_px;
      const double left = std::exp(-blur * (m * m + n * n)) * sinc(x) * sinc(y) * sinc(x * optics.blur_x_px) *
                          sinc(y * optics.blur_y_px);
      series.emplace_back(m == 0 && n == 0 ? 0.0 : optics.contrast * paper(pattern, m, n) * left);
    }
  }
  return {order, series};
}

}  // namespace moiregauge::internal
