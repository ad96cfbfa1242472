// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/scenario/track.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "moiregauge/simulator/scenario/gaussian.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
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

// Returns the integral of the knots. It is exact, because the mean of a straight line is its value in the middle.
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

long step_at(const Track& track, double time_s) {
  return static_cast<long>(std::floor(time_s / track.random_step_s + 0.5));
}

double random_of(const Track& track, long step) {
  if (track.random == 0.0) return 0.0;
  return track.random * (2.0 * hashed_unit(track.random_seed, static_cast<std::uint64_t>(step)) - 1.0);
}

double random_mean(const Track& track, double from_s, double to_s) {
  if (track.random == 0.0) return 0.0;
  double area = 0.0;
  for (long step = step_at(track, from_s); step <= step_at(track, to_s); ++step) {
    const double middle = static_cast<double>(step) * track.random_step_s, half = 0.5 * track.random_step_s;
    const double shared = std::min(to_s, middle + half) - std::max(from_s, middle - half);
    area += std::max(shared, 0.0) * random_of(track, step);
  }
  return area / (to_s - from_s);
}

}  // namespace

double Track::at(double time_s) const {
  const double phase = kTwoPi * frequency_hz * time_s + radians_from_degrees(phase_deg);
  return offset + scale * value_of(knots, time_s) + amplitude * std::sin(phase) +
         random_of(*this, step_at(*this, time_s));
}

double Track::mean(double from_s, double to_s) const {
  if (to_s <= from_s) return at(from_s);
  const double middle = 0.5 * (from_s + to_s);
  const double half_turn = kPi * frequency_hz * (to_s - from_s);
  const double sinc = half_turn == 0.0 ? 1.0 : std::sin(half_turn) / half_turn;
  const double phase = kTwoPi * frequency_hz * middle + radians_from_degrees(phase_deg);
  return offset + scale * area_under(knots, from_s, to_s) / (to_s - from_s) + amplitude * sinc * std::sin(phase) +
         random_mean(*this, from_s, to_s);
}

double Track::limit() const {
  double largest = 0.0;
  for (const Knot& knot : knots) largest = std::max(largest, std::abs(knot.value));
  return std::abs(offset) + std::abs(scale) * largest + std::abs(amplitude) + std::abs(random);
}

std::vector<double> Track::corners(double from_s, double to_s) const {
  std::vector<double> times;
  for (const Knot& knot : knots) times.push_back(knot.time_s);
  if (random != 0.0) {
    for (long step = step_at(*this, from_s); step < step_at(*this, to_s); ++step)
      times.push_back((static_cast<double>(step) + 0.5) * random_step_s);
  }
  std::erase_if(times, [&](double time) { return !(time > from_s && time < to_s); });
  return times;
}

}  // namespace moiregauge::internal::simulator
