// SPDX-License-Identifier: Apache-2.0
#include "studies/trust_scenarios.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "moiregauge/calibration/scene/bundle.h"
#include "studies/lens.h"

namespace moiregauge::internal::study {
namespace {

using simulator::Scenario;
using simulator::SceneMarker;

constexpr long kMeasuredFrames = 5;  // without the reference frame
// Standard deviations for an unknown lens, equal to the priors of the instrument.
constexpr double kCentreWithin = 0.02;       // relative to the image width: principal point
constexpr double kTangentialWithin = 0.005;  // relative to half the diagonal: tangential distortion at the corner

// Returns the same rig with larger pixels: a pitch of 29 px becomes 29 / times px.
Scenario coarser(Scenario s, double times) {
  auto& c = s.camera;
  c.width = static_cast<int>(c.width / times), c.height = static_cast<int>(c.height / times);
  c.fx /= times, c.fy /= times;
  c.cx = (c.cx + 0.5) / times - 0.5, c.cy = (c.cy + 0.5) / times - 0.5;
  return s;
}

Scenario posed(const char* name, double times, double x_deg, double y_deg, double z_deg) {
  Scenario s = coarser(*simulator::built_in(name), times);
  bend(s, -1.0);
  s.mount.rotation_x = {.random = x_deg, .random_seed = 1};
  s.mount.rotation_y = {.random = y_deg, .random_seed = 2};
  s.mount.rotation_z = {.random = z_deg, .random_seed = 3};
  return s;
}

void replace_gratings(Scenario& s, Pattern pattern, double pitch_mm) {
  for (SceneMarker& m : s.markers) m.print.grating->pattern = pattern, m.print.grating->pitch_mm = pitch_mm;
}

SceneMarker& target_of(Scenario& s) {
  return *std::find_if(s.markers.begin(), s.markers.end(),
                       [](const SceneMarker& m) { return m.print.role == Role::kTarget; });
}

void settle_references(Scenario& s) {
  for (SceneMarker& m : s.markers) {
    if (m.print.role == Role::kReference) m.dx = m.dy = {};
  }
}

TrustScenario still() {
  return {"still", "nothing moves but the target, pitch 29 px", posed("small-still", 1.0, 0, 0, 0)};
}
TrustScenario tiny() {
  TrustScenario t{"tiny", "0.1 deg, noise 0.75 DN", posed("small-still", 2.0, 0.1, 0.1, 0.1)};
  t.scenario.sensor.noise_sigma = 0.75;
  return t;
}
TrustScenario tilt() {
  TrustScenario t{"1x", "1 deg about x, dots, pitch 29 px", posed("small-still", 1.0, 1, 0, 0)};
  replace_gratings(t.scenario, Pattern::kDots, 10.0);
  return t;
}
TrustScenario turn() { return {"1xyz", "1 deg about three axes", posed("small-still", 2.0, 1, 1, 1)}; }
TrustScenario cosine() {
  TrustScenario t{"cosine", "the same, cosine print, noise 3 DN", posed("small-still", 2.0, 1, 1, 1)};
  replace_gratings(t.scenario, Pattern::kCosine, 10.0);
  t.scenario.sensor.noise_sigma = 3.0;
  return t;
}
TrustScenario calibrated() {
  TrustScenario t{"calibrated", "1 deg, lens known, 12 bits, noise 0.75 DN", posed("small-still", 2.0, 1, 1, 1), true};
  t.scenario.sensor.bits = 12;
  t.scenario.sensor.noise_sigma = 0.75;
  return t;
}
TrustScenario fine() {
  TrustScenario t{"fine", "1 deg, pitch 8 px", posed("small-still", 2.0, 1, 1, 1)};
  replace_gratings(t.scenario, Pattern::kGrid, 5.5);
  return t;
}
TrustScenario sheet() {
  TrustScenario t{"sheet", "1 deg, one printed sheet: places to 0.05 mm, checkerboard",
                  posed("small-still", 2.0, 1, 1, 1)};
  t.scenario.known_to = {.position_mm = 0.05, .rotation_rad = 2e-4, .height_mm = 0.1, .print_scale = 1e-4};
  replace_gratings(t.scenario, Pattern::kCheckerboard, 10.0);
  return t;
}
TrustScenario six() {
  TrustScenario t{"six", "1 deg, six references", posed("small-six-slip", 2.0, 1, 1, 1)};
  settle_references(t.scenario);
  return t;
}
TrustScenario off_plane() {
  TrustScenario t{"off-plane", "camera travels 5 mm and turns 1 deg, target's height not stated",
                  posed("small-still", 2.0, 1, 1, 1)};
  auto& m = t.scenario.mount;
  for (auto* track : {&m.shift_x, &m.shift_y, &m.shift_z}) track->random = 5.0;
  t.depth_mm = 30.0;
  return t;
}
TrustScenario oblique() {
  TrustScenario t{"oblique", "1 deg about a view of 30 deg from the side, lens known",
                  posed("small-still", 2.0, 1, 1, 1), true};
  t.scenario.mount.board_y_deg = 30.0;
  return t;
}
TrustScenario walk() {
  TrustScenario t{"walk", "1 deg, target walks 60 mm, squares", posed("small-walk", 2.0, 1, 1, 1)};
  replace_gratings(t.scenario, Pattern::kSquares, 10.0);
  return t;
}

// Draws the true camera around the one known to the instrument. `u` has the order of the Scene's parameters.
void draw_camera(simulator::Camera& c, const std::array<double, kCameraParameters>& u, std::mt19937_64& dice) {
  std::normal_distribution<double> normal;
  const double f = u[0] * normal(dice);
  c.fx += f, c.fy += f;
  c.cx += u[1] * normal(dice), c.cy += u[2] * normal(dice);
  c.k1 += u[3] * normal(dice), c.k2 += u[4] * normal(dice);
  c.p1 += u[5] * normal(dice), c.p2 += u[6] * normal(dice);
}

}  // namespace

const std::vector<TrustScenario>& trust_scenarios() {
  static const std::vector<TrustScenario> list{still(), tiny(),  tilt(), turn(),      cosine(),  calibrated(),
                                               fine(),  sheet(), six(),  off_plane(), oblique(), walk()};
  return list;
}

DrawnRun drawn_run(const TrustScenario& kind, int number) {
  DrawnRun run{kind.scenario, {}};
  Scenario& s = run.scenario;
  s.seed = static_cast<std::uint64_t>(number) + 1;
  std::mt19937_64 dice(s.seed);
  std::normal_distribution<double> normal;
  auto& m = s.mount;
  for (auto* track : {&m.rotation_x, &m.rotation_y, &m.rotation_z, &m.shift_x, &m.shift_y, &m.shift_z})
    track->random_seed += 100 * s.seed;
  s.draw = {.position = true, .rotation = true, .height = true, .print_scale = true};
  run.plan.method = "precise";
  run.plan.render_threads = 1;
  run.plan.first = run.plan.step = 7;
  run.plan.frames = kMeasuredFrames;
  if (kind.depth_mm > 0.0) target_of(s).place.z_mm = kind.depth_mm * normal(dice);
  if (kind.lens_known) {
    run.plan.lens = lens_of(s.camera);
    draw_camera(s.camera, scene_prior(simulator::site_of(s), s.camera.width, s.camera.height, run.plan.lens).u_camera,
                dice);
  } else {
    s.camera.cx += kCentreWithin * s.camera.width * normal(dice);
    s.camera.cy += kCentreWithin * s.camera.width * normal(dice);
    const double rho = 0.5 * std::hypot(s.camera.width, s.camera.height) / s.camera.fx;
    s.camera.p1 = kTangentialWithin / rho * normal(dice);
    s.camera.p2 = kTangentialWithin / rho * normal(dice);
  }
  return run;
}

}  // namespace moiregauge::internal::study
