// SPDX-License-Identifier: Apache-2.0
// One axis of a panel: what it shows, how it spaces it, and where it counts.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/drawing/plots/ticks.h"

namespace moiregauge::internal::figure {

enum class Scale { kLinear, kLog };  // log: equal ratios are equal lengths; the range's ends are positive

struct PlotAxis {
  Range range;
  Scale scale = Scale::kLinear;
  // 0 at the low end, 1 at the high end, beyond them outside. On a logarithmic axis a value that is not positive has no
  // place: not a finite number.
  [[nodiscard]] double place(double value) const;
};

struct Tick {
  double value = 0.0;
  std::string label;  // empty: a small tick between decades
};
// Those within the axis, about `most` with a label at most.
[[nodiscard]] std::vector<Tick> ticks_of(const PlotAxis& axis, int most);

// From the smallest to the largest of the values that the scale can show; `rim`, a part of the extent, is left free at
// either end. Of no such value: 0 to 1, logarithmic 0.1 to 1. A single value has no extent.
[[nodiscard]] Range extent_of(const std::vector<double>& values, Scale scale, double rim);
// The axis made so long that it begins and ends at a tick.
[[nodiscard]] PlotAxis to_whole_ticks(PlotAxis axis, int most);

}  // namespace moiregauge::internal::figure
