// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>

#include "moiregauge/simulator/scenario/gaussian.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {
namespace {

bool holds(const std::vector<FrameSpan>& spans, long frame) {
  return std::any_of(spans.begin(), spans.end(), [&](FrameSpan s) { return frame >= s.from && frame < s.to; });
}

// Returns the shot of a frame, without regard to repeated frames.
long own_shot_of(const Scenario& scenario, long frame) {
  const auto& dropped = scenario.timing.dropped;
  if (dropped.empty()) return frame;
  long shot = -1;
  for (long recorded = -1; recorded < frame;) recorded += !holds(dropped, ++shot);
  return shot;
}

// Returns a uniform random number from -1 to 1.
double drawn(const Scenario& scenario, std::uint64_t what, long number) {
  return 2.0 * hashed_unit(scenario.seed + what, static_cast<std::uint64_t>(number)) - 1.0;
}
constexpr std::uint64_t kShots = 7001, kStamps = 7002;

double time_of_shot(const Scenario& scenario, long shot) {
  const double on_time = static_cast<double>(shot) / scenario.sensor.fps;
  if (scenario.timing.jitter_s == 0.0) return on_time;
  return on_time + scenario.timing.jitter_s * drawn(scenario, kShots, shot);
}

}  // namespace

long shot_of(const Scenario& scenario, long frame) {
  while (frame > 0 && holds(scenario.timing.repeated, frame)) --frame;
  return own_shot_of(scenario, frame);
}

double time_of(const Scenario& scenario, long frame) { return time_of_shot(scenario, shot_of(scenario, frame)); }

double stamp_of(const Scenario& scenario, long frame) {
  double stamp = static_cast<double>(frame) / scenario.sensor.fps;
  if (!scenario.timing.nominal_stamps) stamp = time_of_shot(scenario, own_shot_of(scenario, frame));
  if (scenario.timing.stamp_jitter_s == 0.0) return stamp;
  return stamp + scenario.timing.stamp_jitter_s * drawn(scenario, kStamps, frame);
}

double delay_of_row(const Scenario& scenario, int y) {
  const double field = scenario.sensor.interlaced && y % 2 == 1 ? 0.5 / scenario.sensor.fps : 0.0;
  return ((y + 0.5) / scenario.camera.height - 0.5) * scenario.sensor.readout_s + field;
}

}  // namespace moiregauge::internal::simulator
