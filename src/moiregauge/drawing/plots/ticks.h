// SPDX-License-Identifier: Apache-2.0
// Computes the ticks of an axis and their labels.
#pragma once

#include <string>
#include <vector>

namespace moiregauge::internal::figure {

struct Range {
  double low = 0.0, high = 1.0;
};

// Returns multiples of 1, 2 or 5 times a power of ten that cover `range`, at most about `most`. The first is at or
// below its low end, the last at or above its high end. A range of length 0 is widened.
[[nodiscard]] std::vector<double> nice_ticks(Range range, int most);
// Returns powers of ten that cover `range`, whose ends must be positive. It returns every decade, or every second,
// third and so on, to have at most `most`, but at least two. The first is at or below its low end, the last at or above
// its high end.
[[nodiscard]] std::vector<double> decade_ticks(Range range, int most);
// Returns the value with the digits of `step` and a typographic minus sign.
[[nodiscard]] std::string tick_label(double value, double step);

}  // namespace moiregauge::internal::figure
