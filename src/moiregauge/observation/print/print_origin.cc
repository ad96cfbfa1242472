// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/print_origin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Complex = std::complex<double>;

// Largest share of a template's power that is odd about a symmetry point. Chosen.
constexpr double kMaxOddPower = 0.01;

double to_nearest_half(double pitches) { return pitches - 0.5 * std::round(2.0 * pitches); }
double to_nearest_whole(double pitches) { return pitches - std::round(pitches); }

// Returns the nearest crossing of dark lines, or of light ones, which are half a pitch away along both axes.
PrintOrigin of_crossings(Complex x, Complex y) {
  const double dx = to_nearest_whole(-std::arg(x) / kTwoPi), dy = to_nearest_whole(-std::arg(y) / kTwoPi);
  const PrintPoint light{dx, dy}, dark{to_nearest_whole(dx + 0.5), to_nearest_whole(dy + 0.5)};
  const bool is_light = std::hypot(light.x, light.y) < std::hypot(dark.x, dark.y);
  return {is_light ? light : dark, std::sqrt(0.5), 0.0};
}

// Returns the nearest corner or centre of a square. The fundamentals of a checkerboard are along its diagonals.
PrintOrigin of_checkers(Complex up, Complex down) {
  const double u = to_nearest_half(-std::arg(up) / kTwoPi), v = to_nearest_half(-std::arg(down) / kTwoPi);
  return {{0.5 * (u + v), 0.5 * (u - v)}, std::sqrt(0.125), 0.0};
}

PrintOrigin of_lines(Complex c, bool is_x) {
  const double at = to_nearest_half(-std::arg(c) / kTwoPi);
  return {is_x ? PrintPoint{at, 0.0} : PrintPoint{0.0, at}, 0.5, 0.0};
}

}  // namespace

std::optional<PrintOrigin> nearest_symmetry(const PrintSeries& print, bool along_x, bool along_y) {
  const Complex x = print.coefficient(1, 0), y = print.coefficient(0, 1);
  const Complex up = print.coefficient(1, 1), down = print.coefficient(1, -1);
  const bool is_checkered =
      along_x && along_y && std::min(std::abs(up), std::abs(down)) > 2.0 * std::max(std::abs(x), std::abs(y));
  PrintOrigin origin;
  double strongest = 0.0;
  if (is_checkered) {
    origin = of_checkers(up, down);
    strongest = std::sqrt(2.0) * std::min(std::abs(up), std::abs(down));
  } else if (along_x && along_y) {
    origin = of_crossings(x, y);
    strongest = std::min(std::abs(x), std::abs(y));
  } else {
    origin = of_lines(along_x ? x : y, along_x);
    strongest = std::abs(along_x ? x : y);
  }
  const PrintSeries moved = with_origin(print, origin.at);
  double odd = 0.0, all = 0.0;
  int count = 0;
  for (int n = -print.order(); n <= print.order(); ++n) {
    for (int m = -print.order(); m <= print.order(); ++m) {
      const Complex c = moved.coefficient(m, n);
      if ((!along_x && m != 0) || (!along_y && n != 0)) continue;
      odd += c.imag() * c.imag(), all += std::norm(c);
      ++count;
    }
  }
  if (!(strongest > 0.0) || !(odd < kMaxOddPower * all)) return std::nullopt;
  origin.u = std::sqrt(odd / count) / (kTwoPi * strongest);
  return origin;
}

PrintSeries with_origin(const PrintSeries& print, PrintPoint origin) {
  std::vector<Complex> series;
  for (int n = -print.order(); n <= print.order(); ++n) {
    for (int m = -print.order(); m <= print.order(); ++m)
      series.push_back(print.coefficient(m, n) * std::polar(1.0, kTwoPi * (m * origin.x + n * origin.y)));
  }
  return {print.order(), series};
}

}  // namespace moiregauge::internal
