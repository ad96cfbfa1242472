// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/overshoot.h"

#include <algorithm>
#include <limits>

#include "moiregauge/observation/print/print_origin.h"

namespace moiregauge::internal {
namespace {

constexpr int kSide = 64;  // samples per period

struct Levels {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double level) { low = std::min(low, level), high = std::max(high, level); }
};

}  // namespace

double overshoot_of(const PrintModel& print) {
  const auto origin = nearest_symmetry(print.print, print.options.along_x, print.options.along_y);
  if (!origin) return 0.0;
  Levels plateaus, all;
  // Only a checkerboard has its symmetry points that near: the centres of its squares, and the corners between them.
  const bool has_corners = origin->spacing < 0.5;
  for (const double y : {0.0, 0.5}) {
    for (const double x : {0.0, 0.5}) {
      plateaus.add(print.print.at({origin->at.x + x, origin->at.y + y}).t);
      if (has_corners) plateaus.add(print.print.at({origin->at.x + x + 0.25, origin->at.y + y + 0.25}).t);
    }
  }
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i)
      all.add(print.print.at({static_cast<double>(i) / kSide, static_cast<double>(j) / kSide}).t);
  }
  const double span = plateaus.high - plateaus.low;
  if (!(span > 0.0)) return 0.0;
  return std::max({0.0, all.high - plateaus.high, plateaus.low - all.low}) / span;
}

}  // namespace moiregauge::internal
