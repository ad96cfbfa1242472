// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/plots/plot_axis.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal::figure {
namespace {

std::vector<double> labelled(const PlotAxis& axis, int most) {
  return axis.scale == Scale::kLog ? decade_ticks(axis.range, most) : nice_ticks(axis.range, most);
}

}  // namespace

double PlotAxis::place(double value) const {
  if (scale == Scale::kLinear) return (value - range.low) / (range.high - range.low);
  return std::log(value / range.low) / std::log(range.high / range.low);
}

std::vector<Tick> ticks_of(const PlotAxis& axis, int most) {
  constexpr double kSlack = 1e-9;  // relative to the axis length: includes ticks at its ends
  const auto values = labelled(axis, most);
  std::vector<Tick> ticks;
  const auto put = [&](double value, std::string label) {
    if (const double at = axis.place(value); at > -kSlack && at < 1.0 + kSlack)
      ticks.push_back({value, std::move(label)});
  };
  const bool is_log = axis.scale == Scale::kLog;
  for (const double v : values) {
    put(v, tick_label(v, is_log ? v : values[1] - values[0]));
    if (!is_log || values[1] > 10.5 * values[0]) continue;  // no small ticks between decades that are skipped
    for (int i = 2; i < 10; ++i) put(i * v, "");
  }
  return ticks;
}

Range extent_of(const std::vector<double>& values, Scale scale, double rim) {
  const bool is_log = scale == Scale::kLog;
  Range range{1.0, 0.0};
  for (const double v : values) {
    if (!std::isfinite(v) || (is_log && v <= 0.0)) continue;
    const bool is_first = range.low > range.high;
    range = is_first ? Range{v, v} : Range{std::min(range.low, v), std::max(range.high, v)};
  }
  if (range.low > range.high) return is_log ? Range{0.1, 1.0} : Range{0.0, 1.0};
  if (is_log) {
    const double ratio = std::pow(range.high / range.low, rim);
    return {range.low / ratio, range.high * ratio};
  }
  const double free = rim * (range.high - range.low);
  return {range.low - free, range.high + free};
}

PlotAxis to_whole_ticks(PlotAxis axis, int most) {
  const auto ticks = labelled(axis, most);
  axis.range = {ticks.front(), ticks.back()};
  return axis;
}

}  // namespace moiregauge::internal::figure
