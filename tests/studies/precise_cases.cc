// SPDX-License-Identifier: Apache-2.0
#include "studies/precise_cases.h"

#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "studies/lens.h"

namespace moiregauge::internal::study {
namespace {

using simulator::Scenario;
using simulator::Track;

Scenario scene(const char* name) { return *simulator::built_in(name); }

void set_pattern(Scenario& s, Pattern pattern) {
  for (auto& marker : s.markers) marker.print.grating->pattern = pattern;
}

void draw_poses(Scenario& s, double x_deg, double y_deg, double z_deg) {
  s.mount.rotation_x.random = x_deg;
  s.mount.rotation_y.random = y_deg;
  s.mount.rotation_z.random = z_deg;
}

Scenario small(double percent, double within_deg) {
  Scenario s = scene("small-still");
  bend(s, percent);
  draw_poses(s, within_deg, within_deg, within_deg);
  return s;
}

// Returns the small rig in a larger image, with room for rotations of 4 degrees.
Scenario small_in_large_picture(double percent) {
  Scenario s = scene("small-still");
  constexpr int kMore = 320;
  s.camera.width += 2 * kMore;
  s.camera.height += 2 * kMore;
  s.camera.cx += kMore;
  s.camera.cy += kMore;
  bend(s, percent);
  draw_poses(s, 4.0, 4.0, 4.0);
  return s;
}

// Returns random camera positions around the board, within +-within_deg in azimuth and half of it in elevation.
Scenario orbit(double percent, double within_deg) {
  Scenario s = scene("small-still");
  s.mount.pivot_z_mm = s.mount.distance_mm;
  bend(s, percent);
  draw_poses(s, 0.5 * within_deg, within_deg, 0.0);
  state_heights(s, 0.05);  // unknown, the target's would dominate u
  return s;
}

// The target rests for the first ten frames (1 s) and then moves by up to 2 mm.
Scenario travel(const char* name) {
  Scenario s = scene(name);
  bend(s, -1.0);
  s.markers.back().dy.knots = {{1.0, 0}, {3.0, 1}, {3.5, 1}, {5.5, 2}, {6.0, 2}};
  return s;
}

void add_known_lens(std::vector<PreciseCase>& all) {
  struct View {
    const char* name;
    Scenario scenario;
  };
  for (const Pattern pattern : {Pattern::kCosine, Pattern::kGrid}) {
    const bool is_cosine = pattern == Pattern::kCosine;
    for (const View& view : {View{"0", small(-1.0, 0.0)},
                             {"8", small_in_large_picture(-1.0)},
                             {"20", orbit(-1.0, 20.0)},
                             {"40", orbit(-1.0, 40.0)}}) {
      PreciseCase c{.name = fmt::format("known-{}-{}", is_cosine ? "cos" : "bin", view.name),
                    .gate = is_cosine ? "<= 1.15 x" : "<= 1.5 x full",
                    .scenario = view.scenario,
                    .lens_known = true,
                    .heights_known = true,
                    .frames = 21};
      set_pattern(c.scenario, pattern);
      if (!is_cosine) c.bound = Bound::kFull;
      all.push_back(c);
    }
  }
  for (const View& view : {View{"8", small_in_large_picture(-1.0)}, {"20", orbit(-1.0, 20.0)}}) {
    all.push_back({.name = fmt::format("solved-bin-{}", view.name),
                   .gate = "<= 2.2 x full",
                   .scenario = view.scenario,
                   .bound = Bound::kFull,
                   .heights_known = true,
                   .frames = 30});
  }
}

void add_unknown_lens(std::vector<PreciseCase>& all) {
  for (const double percent : {-0.3, -1.0, -2.0}) {
    for (const bool tangential : {false, true}) {
      PreciseCase c{.name = fmt::format("unknown{}{}-60", percent, tangential ? "-p" : ""),
                    .gate = "<= 1.0 x",
                    .scenario = small(percent, 1.0)};
      if (tangential) c.scenario.camera.p1 = 0.003, c.scenario.camera.p2 = -0.002;
      all.push_back(c);
    }
  }
  all.push_back({.name = "unknown-1-cos-60", .gate = "<= 1.5 x", .scenario = small(-1.0, 1.0)});
  set_pattern(all.back().scenario, Pattern::kCosine);
  all.push_back(
      {.name = "unknown-1-10", .gate = "<= 2 x", .scenario = small(-1.0, 1.0), .frames = 10, .step = 6, .runs = 20});
  all.push_back(
      {.name = "unknown-1-5", .gate = "<= 3 x", .scenario = small(-1.0, 1.0), .frames = 5, .step = 12, .runs = 40});
  PreciseCase rig{
      .name = "unknown-1-rig-8", .gate = "<= 1.0 x", .scenario = scene("rig-1x"), .runs = 2, .coverage_runs = 0};
  rig.scenario.mount.rotation_x.knots.clear();
  rig.scenario.camera.k1 = -0.0225;
  draw_poses(rig.scenario, 4.0, 4.0, 4.0);
  all.push_back(rig);
  for (auto& c : all) {
    if (c.name.starts_with("unknown")) c.scenario.known_to.position_mm = 5.0;
  }
  all.push_back({.name = "tiny-0.1", .gate = "<= 1.5 x", .scenario = small(-1.0, 0.1)});
  all.push_back({.name = "still", .gate = "<= 1.5 x", .scenario = small(-1.0, 0.0)});
}

void add_travel(std::vector<PreciseCase>& all) {
  for (const bool far : {false, true}) {
    const Scenario s = travel(far ? "small-travel-50" : "small-travel-5");
    const std::string name = far ? "travel-50" : "travel-5";
    all.push_back({.name = name, .gate = far ? "<= 8 um" : "<= 1.5 um", .scenario = s, .frames = 40});
    all.push_back({.name = name + "-rest",
                   .gate = "<= 1.5 um",
                   .scenario = s,
                   .rest = FrameRange{.first = 0, .end = 10},
                   .frames = 40,
                   .coverage_frames = 20,
                   .coverage_step = 2});
  }
}

void add_events(std::vector<PreciseCase>& all) {
  all.push_back({.name = "walk", .gate = "<= 2 x, every order", .scenario = scene("small-walk"), .coverage_step = 1});
  all.push_back({.name = "six-slip",
                 .gate = "rms as six-still",
                 .scenario = scene("small-six-slip"),
                 .frames = 80,
                 .step = 2,
                 .coverage_frames = 12,
                 .coverage_step = 12});
  Scenario six = scene("small-six-slip");
  for (auto& marker : six.markers) {
    if (marker.print.role == Role::kReference) marker.dy = Track{};
  }
  all.push_back({.name = "six-still",
                 .gate = "<= 1.5 x",
                 .scenario = six,
                 .frames = 80,
                 .step = 2,
                 .coverage_frames = 12,
                 .coverage_step = 12});
  all.push_back({.name = "covered",
                 .gate = "no covered ok",
                 .scenario = scene("small-covered"),
                 .frames = 110,
                 .coverage_runs = 0});
}

// Returns a camera with a rolling shutter (readout time 18 ms, 30 frames/s) that sways and trembles.
Scenario rolling(double sway_deg, double tremor_deg, double tremor_hz) {
  Scenario s = scene("small-still");
  bend(s, -1.0);
  s.sensor.fps = 30.0;
  s.sensor.readout_s = 0.018;
  s.sensor.exposure_s = 1.0 / 500.0;
  auto& m = s.mount;
  double turn = 40.0;  // phase: in rad for the sway, in degrees for the tremor; differs between the six tracks
  for (Track* track : {&m.rotation_x, &m.rotation_y, &m.rotation_z}) {
    // A swaying hand: straight lines between knots at intervals of 0.25 s.
    for (int k = 0; k <= 80; ++k) {
      const double t = 0.25 * k;
      track->knots.push_back({t, sway_deg * std::sin(2.0 * t + turn)});
    }
    track->amplitude = tremor_deg, track->frequency_hz = tremor_hz, track->phase_deg = turn += 77.0;
  }
  for (Track* track : {&m.shift_x, &m.shift_y, &m.shift_z})
    track->amplitude = 4.0 * tremor_deg, track->frequency_hz = 0.8 * tremor_hz, track->phase_deg = turn += 77.0;
  return s;
}

void add_rolling(std::vector<PreciseCase>& all) {
  const auto add = [&all](std::string name, std::string gate, Scenario s, std::optional<double> readout_s = {}) {
    PreciseCase c{.name = "rolling-" + std::move(name), .gate = std::move(gate), .scenario = std::move(s)};
    c.readout_s = readout_s;
    c.frames = 45, c.runs = 5;
    c.coverage_frames = 20, c.coverage_step = 1, c.coverage_runs = 40;
    all.push_back(std::move(c));
  };
  add("tremor", "no lies", rolling(0.3, 0.06, 8.0));
  add("tremor-given", "no lies", rolling(0.3, 0.06, 8.0), 0.018);
  add("sway", "<= 1.5 x", rolling(0.5, 0.0, 0.0));
  add("vibration-13", "no lies", rolling(0.3, 0.02, 13.0), 0.018);
  add("vibration-25", "no lies", rolling(0.3, 0.01, 25.0), 0.018);
  add("vibration-40", "no lies", rolling(0.3, 0.02, 40.0));
  add("still", "<= 1.5 x", rolling(0.0, 0.0, 0.0));
  Scenario slow = rolling(0.3, 0.06, 8.0);
  slow.sensor.fps = 10.0;
  add("tremor-10fps", "no lies", slow);
  Scenario moving = rolling(0.3, 0.03, 8.0);
  moving.markers.back().print.grating->centre = {0.0, 55.0};
  moving.markers.back().dy.amplitude = 1.0, moving.markers.back().dy.frequency_hz = 3.0;
  moving.markers.back().dx.amplitude = 0.5, moving.markers.back().dx.frequency_hz = 2.3;
  add("target", "no lies", moving);
}

}  // namespace

void state_heights(Scenario& scenario, double u_mm) {
  for (auto& marker : scenario.markers) marker.print.z_mm = 0.0;
  scenario.known_to.height_mm = u_mm;
}

const std::vector<PreciseCase>& precise_cases() {
  static const std::vector<PreciseCase> list = [] {
    std::vector<PreciseCase> all;
    add_known_lens(all);
    add_unknown_lens(all);
    add_travel(all);
    add_events(all);
    add_rolling(all);
    return all;
  }();
  return list;
}

Scenario redrawn(const Scenario& scenario, int seed) {
  Scenario s = scenario;
  s.seed = static_cast<std::uint64_t>(seed);
  auto& m = s.mount;
  for (Track* track : {&m.rotation_x, &m.rotation_y, &m.rotation_z, &m.shift_x, &m.shift_y, &m.shift_z})
    track->random_seed += 100 * s.seed;
  return s;
}

}  // namespace moiregauge::internal::study
