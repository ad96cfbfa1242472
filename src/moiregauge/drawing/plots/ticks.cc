// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/plots/ticks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal::figure {

std::vector<double> nice_ticks(Range range, int most) {
  if (!(range.high > range.low)) {
    const double half = range.low == 0.0 ? 1.0 : 0.1 * std::abs(range.low);
    range = {range.low - half, range.low + half};
  }
  double step = std::pow(10.0, std::floor(std::log10((range.high - range.low) / std::max(most, 1))) - 1.0);
  constexpr double kSlack = 1e-9;  // relative to a step: an end at a tick needs no further one
  const auto first = [&] { return std::floor(range.low / step + kSlack); };
  const auto last = [&] { return std::ceil(range.high / step - kSlack); };
  for (int i = 0; last() - first() + 1.0 > std::max(most, 2); ++i) step *= i % 3 == 1 ? 2.5 : 2.0;  // 1, 2, 5, 10
  std::vector<double> ticks;
  for (double i = first(); i <= last(); i += 1.0) ticks.push_back(i * step);
  return ticks;
}

std::vector<double> decade_ticks(Range range, int most) {
  constexpr double kSlack = 1e-9;  // relative to a decade: an end at a power of ten needs no further one
  const double low = std::log10(range.low) + kSlack, high = std::log10(range.high) - kSlack;
  int step = 1;  // decades
  const auto first = [&] { return static_cast<int>(std::floor(low / step)); };
  const auto last = [&] { return std::max(static_cast<int>(std::ceil(high / step)), first() + 1); };
  while (last() - first() + 1 > std::max(most, 2)) ++step;
  std::vector<double> ticks;
  for (int i = first(); i <= last(); ++i) ticks.push_back(std::pow(10.0, i * step));
  return ticks;
}

std::string tick_label(double value, double step) {
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const std::string words = fmt::format("{:.{}f}", std::abs(value), digits);
  return value < -1e-9 * step ? "\u2212" + words : words;
}

}  // namespace moiregauge::internal::figure
