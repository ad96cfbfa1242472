// SPDX-License-Identifier: Apache-2.0
#include "studies/jumping_targets.h"

#include <cmath>
#include <random>

#include <fmt/format.h>

#include "studies/dice.h"

namespace moiregauge::internal::study {
namespace {

using simulator::Scenario;
using simulator::SceneMarker;

constexpr double kMargin_mm = 2.0;                     // mm, white paper around a grating
constexpr double kReach = 2.2;                         // pitches, largest displacement along each axis
constexpr double kRoomX_mm = 105.0, kRoomY_mm = 72.0;  // mm, half width and half height of the area of the targets

SceneMarker corner_reference(double x, double y) {
  SceneMarker m;
  m.print.name = fmt::format("{}{}", y > 0.0 ? 'N' : 'S', x > 0.0 ? 'E' : 'W');
  m.print.circle = Circle{{x, y > 0.0 ? y - 26.0 : y + 26.0}, 16.0};
  m.print.grating = {.centre = {x, y}, .width_mm = 30.0, .height_mm = 30.0, .pitch_mm = 5.0, .pattern = Pattern::kGrid};
  m.paper_margin_mm = kMargin_mm;
  return m;
}

// Returns a random displacement in mm: 30 % whole pitches, 20 % half pitches, otherwise uniform.
double jump(Dice& dice, double pitch_mm) {
  const double pitches = uniform(dice, -kReach, kReach), kind = uniform(dice, 0.0, 1.0);
  if (kind < 0.3) return pitch_mm * std::round(pitches);
  return kind < 0.5 ? 0.5 * pitch_mm * std::round(2.0 * pitches) : pitch_mm * pitches;
}

simulator::Track jumps(Dice& dice, double pitch_mm, double fps) {
  simulator::Track track;
  track.knots.push_back({0.0, 0.0});
  for (long frame = 1; frame <= kJumps; ++frame) {
    const double place = jump(dice, pitch_mm), t = static_cast<double>(frame);
    track.knots.push_back({(t - 0.4) / fps, place});
    track.knots.push_back({(t + 0.4) / fps, place});
  }
  return track;
}

SceneMarker target_at(BoardPoint centre, const JumpKind& kind, std::size_t number, Dice& dice, double fps) {
  SceneMarker m;
  m.print.name = fmt::format("T{}", number);
  m.print.role = Role::kTarget;
  const double size = kind.pitches * kind.pitch_mm;
  m.print.grating = {
      .centre = centre, .width_mm = size, .height_mm = size, .pitch_mm = kind.pitch_mm, .pattern = kind.pattern};
  m.paper_margin_mm = kMargin_mm;
  m.dx = jumps(dice, kind.pitch_mm, fps);
  m.dy = jumps(dice, kind.pitch_mm, fps);
  if (uniform(dice, 0.0, 1.0) < kind.covered) {
    const auto from = std::uniform_int_distribution<long>(1, kJumps - 3)(dice);
    m.cover.frames = {{from, from + 4}};
    m.cover.share = uniform(dice, 0.3, 1.0);
    m.cover.grey = uniform(dice, 40.0, 210.0);
  }
  return m;
}

}  // namespace

Scenario jumping_targets(const JumpKind& kind, int number) {
  Scenario s = *simulator::built_in("small-still");
  s.camera.k1 = -0.37;  // -1 % at the corner of the image
  s.seed = static_cast<std::uint64_t>(number) + 1;
  s.sensor.noise_sigma = kind.noise;
  s.sensor.psf_sigma_px = kind.psf_px;
  s.draw = {.position = true, .rotation = true, .height = true, .print_scale = true};
  s.mount.rotation_x = {.random = 0.4, .random_seed = 10 * s.seed + 1};
  s.mount.rotation_y = {.random = 0.4, .random_seed = 10 * s.seed + 2};
  s.mount.rotation_z = {.random = 1.0, .random_seed = 10 * s.seed + 3};
  s.markers.clear();
  for (const double y : {62.0, -62.0}) {
    for (const double x : {-132.0, 132.0}) s.markers.push_back(corner_reference(x, y));
  }
  Dice dice(s.seed * 7919);
  const double cell = kind.pitch_mm * (kind.pitches + 2.0 * kReach) + 2.0 * kMargin_mm;
  const int across = static_cast<int>(2.0 * kRoomX_mm / cell), up = static_cast<int>(2.0 * kRoomY_mm / cell);
  for (int row = 0; row < up; ++row) {
    for (int column = 0; column < across; ++column) {
      const BoardPoint centre{(column - 0.5 * (across - 1)) * cell, (row - 0.5 * (up - 1)) * cell};
      s.markers.push_back(target_at(centre, kind, s.markers.size() - 3, dice, s.sensor.fps));
    }
  }
  return s;
}

}  // namespace moiregauge::internal::study
