// SPDX-License-Identifier: Apache-2.0
// Where an axis counts, and in which digits.
#pragma once

#include <string>
#include <vector>

namespace moiregauge::internal::figure {

struct Range {
  double low = 0.0, high = 1.0;
};

// Multiples of 1, 2 or 5 times a power of ten that cover `range`, about `most` of them at most; the first is at or
// below its low end, the last at or above its high end. A range without extent is widened.
[[nodiscard]] std::vector<double> nice_ticks(Range range, int most);
// Powers of ten that cover `range`, whose ends are positive: all of them or every second, third ..., so that they are
// `most` at most, but two at least; the first is at or below its low end, the last at or above its high end.
[[nodiscard]] std::vector<double> decade_ticks(Range range, int most);
// With the digits that `step` needs, and a true minus sign.
[[nodiscard]] std::string tick_label(double value, double step);

}  // namespace moiregauge::internal::figure
