// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/track.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "moiregauge/units/units.h"

namespace moiregauge::simulator {
namespace {

double value_of(const std::vector<Knot>& knots, double time_s) {
  if (knots.empty()) return 0.0;
  if (time_s <= knots.front().time_s) return knots.front().value;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const Knot& a = knots[i - 1];
    const Knot& b = knots[i];
    if (time_s < b.time_s) return a.value + (b.value - a.value) * ((time_s - a.time_s) / (b.time_s - a.time_s));
  }
  return knots.back().value;
}

// The area under the knots; exact, since a straight piece's mean is its middle's value.
double area_under(const std::vector<Knot>& knots, double from_s, double to_s) {
  double area = 0.0;
  double at = from_s;
  const auto add_piece = [&](double end) {
    if (end <= at) return;
    area += value_of(knots, 0.5 * (at + end)) * (end - at);
    at = end;
  };
  for (const Knot& knot : knots) add_piece(std::min(knot.time_s, to_s));
  add_piece(to_s);
  return area;
}

}  // namespace

double Track::at(double time_s) const {
  const double phase = kTurn * frequency_hz * time_s + radians_from_degrees(phase_deg);
  return offset + scale * value_of(knots, time_s) + amplitude * std::sin(phase);
}

double Track::mean(double from_s, double to_s) const {
  if (to_s <= from_s) return at(from_s);
  const double middle = 0.5 * (from_s + to_s);
  const double half_turn = kPi * frequency_hz * (to_s - from_s);
  const double sinc = half_turn == 0.0 ? 1.0 : std::sin(half_turn) / half_turn;
  const double phase = kTurn * frequency_hz * middle + radians_from_degrees(phase_deg);
  return offset + scale * area_under(knots, from_s, to_s) / (to_s - from_s) + amplitude * sinc * std::sin(phase);
}

}  // namespace moiregauge::simulator
