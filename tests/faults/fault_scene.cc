// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "faults/fault_cases.h"

namespace moiregauge::internal::faults {
namespace {

using simulator::Mount;
using simulator::Scenario;

enum class Hold { kTripod, kTurning, kSwaying, kPosed };

void move_camera(Mount& mount, Hold hold, int seed) {
  simulator::Track* const turns[] = {&mount.rotation_x, &mount.rotation_y, &mount.rotation_z};
  int axis = 0;
  for (simulator::Track* track : turns) {
    ++axis;
    track->random_step_s = 1.0;
    track->random_seed = static_cast<std::uint64_t>(seed * 16 + axis);
    if (hold == Hold::kTurning) track->knots = {{0.0, 0.0}, {16.0, 0.9}};
    if (hold == Hold::kSwaying) {
      track->amplitude = 0.35;
      track->frequency_hz = 0.11 + 0.05 * axis;
      track->phase_deg = 67.0 * axis + 31.0 * seed;
    }
    if (hold == Hold::kPosed) track->random = 0.6;
  }
}

}  // namespace

Scenario scene_of(int seed) {
  Scenario s = *simulator::built_in(seed % 2 == 0 ? "small-still" : "small-six-slip");
  s.mount.rotation_x.knots = s.mount.rotation_y.knots = s.mount.rotation_z.knots = {};
  for (auto& marker : s.markers) {
    if (marker.print.role == Role::kReference) marker.dy = {};
    if (marker.print.role == Role::kTarget)
      marker.dx = {.amplitude = 0.4, .frequency_hz = 0.13, .phase_deg = 17.0 * seed};
  }
  const double lenses[] = {0.0, -0.37, -0.12};
  s.camera.k1 = lenses[(seed / 2) % 3];
  move_camera(s.mount, static_cast<Hold>((seed / 2) % 4), seed);
  s.draw = {.position = true, .rotation = true, .height = true, .print_scale = true};
  s.sensor.fps = 1.0;
  s.frames = 10;
  s.seed = 5000 + static_cast<std::uint64_t>(seed);
  return s;
}

Sequence sequence_of(const Mode& mode, std::size_t strength, int seed) {
  Sequence sequence{mode.name, mode.strengths[strength].words, scene_of(seed), {}};
  sequence.scenario.name = mode.name;
  if (mode.strengths[strength].apply) mode.strengths[strength].apply(sequence, seed);
  return sequence;
}

}  // namespace moiregauge::internal::faults
