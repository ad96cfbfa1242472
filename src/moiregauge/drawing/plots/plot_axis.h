// SPDX-License-Identifier: Apache-2.0
// One axis of a panel: range, scale and ticks.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/drawing/plots/ticks.h"

namespace moiregauge::internal::figure {

enum class Scale { kLinear, kLog };  // log: equal ratios have equal lengths; the ends of the range are positive

struct PlotAxis {
  Range range;
  Scale scale = Scale::kLinear;
  // Returns 0 at the low end and 1 at the high end. Values outside are below 0 or above 1. On a logarithmic axis the
  // result is not finite for values that are not positive.
  [[nodiscard]] double place(double value) const;
};

struct Tick {
  double value = 0.0;
  std::string label;  // empty: a small tick between decades
};
// Returns the ticks within the axis, at most about `most` of them with a label.
[[nodiscard]] std::vector<Tick> ticks_of(const PlotAxis& axis, int most);

// Returns the range of the values that the scale can show, extended by the share `rim` at either end. Without such
// values: 0 to 1, logarithmic 0.1 to 1. A single value gives a range of length 0.
[[nodiscard]] Range extent_of(const std::vector<double>& values, Scale scale, double rim);
// Returns the axis extended to begin and end at a tick.
[[nodiscard]] PlotAxis to_whole_ticks(PlotAxis axis, int most);

}  // namespace moiregauge::internal::figure
