// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/scenario/built_in.h"

#include <array>
#include <cstddef>
#include <initializer_list>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

constexpr double kRunLength_s = 16.0;

struct Layout {
  double circle_x_mm, circle_y_mm, circle_diameter_mm;
  double grating_x_mm, grating_y_mm, reference_mm, target_mm;
};

struct Sway {
  std::string_view suffix;
  double from_deg, to_deg;
  bool all_axes;
};

constexpr std::array kSways{
    Sway{"0.1x", 0.0, 0.1, false},
    Sway{"1x", 0.0, 1.0, false},
    Sway{"1xyz", 0.0, 1.0, true},
    Sway{"8xyz", -4.0, 4.0, true},
};

Grating crossed_lines(BoardPoint centre, double size_mm) {
  return {.centre = centre, .width_mm = size_mm, .height_mm = size_mm, .pitch_mm = 10.0, .pattern = Pattern::kGrid};
}

void place_markers(Scenario& scenario, const Layout& layout) {
  struct Corner {
    const char* name;
    double x, y;
  };
  for (const Corner& corner : {Corner{"NW", -1, 1}, Corner{"NE", 1, 1}, Corner{"SW", -1, -1}, Corner{"SE", 1, -1}}) {
    SceneMarker marker;
    marker.print.name = corner.name;
    marker.print.circle =
        Circle{{corner.x * layout.circle_x_mm, corner.y * layout.circle_y_mm}, layout.circle_diameter_mm};
    marker.print.grating =
        crossed_lines({corner.x * layout.grating_x_mm, corner.y * layout.grating_y_mm}, layout.reference_mm);
    scenario.markers.push_back(marker);
  }
  SceneMarker target;
  target.print.name = "mid";
  target.print.role = Role::kTarget;
  target.print.grating = crossed_lines({0.0, 0.0}, layout.target_mm);
  target.dy = paper_motion();
  scenario.markers.push_back(target);
}

Scenario rig() {
  Scenario scenario;
  scenario.camera = {.width = 4104, .height = 1012, .cx = 2059.3, .cy = 494.3};
  place_markers(scenario, {380.0, 28.0, 20.0, 340.0, 28.0, 40.0, 60.0});
  return scenario;
}

Scenario small_rig() {
  Scenario scenario;
  place_markers(scenario, {128.0, 40.0, 16.0, 100.0, 40.0, 30.0, 40.0});
  return scenario;
}

void turn(Mount& mount, const Sway& sway) {
  const std::vector<Knot> knots{{0.0, sway.from_deg}, {kRunLength_s, sway.to_deg}};
  mount.rotation_x.knots = knots;
  if (sway.all_axes) mount.rotation_y.knots = mount.rotation_z.knots = knots;
}

void draw_poses(Mount& mount, double within_deg, double within_mm) {
  for (Track* track : {&mount.rotation_x, &mount.rotation_y, &mount.rotation_z}) track->random = within_deg;
  for (Track* track : {&mount.shift_x, &mount.shift_y, &mount.shift_z}) track->random = within_mm;
}

// Moves the camera around the board's middle, which stays at its image position and distance. The elevation is a
// sine of half the angle.
void orbit(Scenario& scenario, double angle_deg) {
  scenario.mount.pivot_z_mm = scenario.mount.distance_mm;
  scenario.mount.rotation_y.knots = {{0.0, -angle_deg}, {kRunLength_s, angle_deg}};
  scenario.mount.rotation_x.amplitude = 0.5 * angle_deg;
  scenario.mount.rotation_x.frequency_hz = 1.0 / kRunLength_s;
}

SceneMarker& marker_named(Scenario& scenario, std::string_view name) {
  for (SceneMarker& marker : scenario.markers) {
    if (marker.print.name == name) return marker;
  }
  return scenario.markers.front();
}

// Moves the camera and the target's plane. The site does not state the target's height, so the instrument must find it.
void travel(Scenario& scenario, double within_mm) {
  draw_poses(scenario.mount, 1.0, within_mm);
  marker_named(scenario, "mid").place.z_mm = -30.0;
}

// Adds 160 px on each side of the image.
void enlarge(Camera& camera) {
  constexpr int kMore = 160;
  camera.width += 2 * kMore;
  camera.height += 2 * kMore;
  camera.cx += kMore;
  camera.cy += kMore;
}

// Moves the target by up to 63 mm/s: 6.3 mm or 0.63 pitch per frame.
void walk(Scenario& scenario) {
  turn(scenario.mount, kSways[2]);
  SceneMarker& target = marker_named(scenario, "mid");
  target.print.grating->centre = {0.0, -30.0};
  target.dy = Track{.offset = 30.0, .amplitude = 30.0, .frequency_hz = 63.0 / (30.0 * kTwoPi), .phase_deg = -90.0};
}

void add_two_references(Scenario& scenario) {
  for (const double side : {-1.0, 1.0}) {
    SceneMarker marker;
    marker.print.name = side < 0.0 ? "W" : "E";
    marker.print.circle = Circle{{52.0 * side, 20.0 * side}, 16.0};
    marker.print.grating = crossed_lines({52.0 * side, -14.0 * side}, 30.0);
    marker.paper_margin_mm = 7.0;
    scenario.markers.insert(scenario.markers.end() - 1, marker);
  }
}

// Layout of the wall in front of the drone, without mirror or rotational symmetry.
struct WallPrint {
  const char* name;
  double x_mm, y_mm;
};

constexpr std::array kWallReferences{WallPrint{"NW", -3700, 1350}, WallPrint{"N", -400, 1500},
                                     WallPrint{"NE", 3600, 1250},  WallPrint{"SW", -3500, -1400},
                                     WallPrint{"S", 600, -1350},   WallPrint{"SE", 3750, -1300}};
constexpr std::array kWallTargets{WallPrint{"T1", -1700, 100}, WallPrint{"T2", 300, -150}, WallPrint{"T3", 1900, 200}};

SceneMarker wall_print(const WallPrint& print, double apart) {
  SceneMarker marker;
  marker.print.name = print.name;
  marker.print.grating = crossed_lines({apart * print.x_mm, apart * print.y_mm}, 420.0);
  marker.print.grating->pitch_mm = 60.0;
  marker.paper_margin_mm = 40.0;
  return marker;
}

// Moves the drone by slow sines of different frequencies, so that the combinations of poses vary.
void hover(Mount& mount, double within_mm, double within_deg) {
  constexpr std::array kHertz{0.11, 0.17, 0.07, 0.13, 0.19, 0.09};
  const std::array tracks{&mount.shift_x,    &mount.shift_y,    &mount.shift_z,
                          &mount.rotation_x, &mount.rotation_y, &mount.rotation_z};
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    tracks[i]->amplitude = i < 3 ? within_mm : within_deg;
    tracks[i]->frequency_hz = kHertz[i];
    tracks[i]->phase_deg = 60.0 * static_cast<double>(i);
  }
  mount.pivot_z_mm = 0.0;
}

// Returns the drone scenario. `size` scales image, focal length and distance: 1 is 3840x2160 from 8 m. `apart` scales
// the distances between the markers, which keep their size.
Scenario drone(double size, double apart) {
  Scenario scenario;
  const int width = static_cast<int>(3840 * size), height = static_cast<int>(2160 * size);
  scenario.camera = {.width = width, .height = height, .fx = 2800.0 * size, .fy = 2800.0 * size};
  scenario.camera.cx = 0.5 * width - 0.5 + 6.3;
  scenario.camera.cy = 0.5 * height - 0.5 - 4.7;
  scenario.mount.distance_mm = 8000.0 * size;
  hover(scenario.mount, 500.0 * size, 3.0);
  scenario.sensor.exposure_s = 1.0 / 1000.0;
  for (const WallPrint& print : kWallReferences) {
    SceneMarker marker = wall_print(print, apart);
    const BoardPoint grating = marker.print.grating->centre;
    marker.print.circle = Circle{{grating.x - 360.0, grating.y}, 160.0};
    scenario.markers.push_back(marker);
  }
  for (const WallPrint& print : kWallTargets) {
    SceneMarker marker = wall_print(print, apart);
    marker.print.role = Role::kTarget;
    scenario.markers.push_back(marker);
  }
  marker_named(scenario, "T1").dy = paper_motion();
  marker_named(scenario, "T2").dx = {.amplitude = 2.0, .frequency_hz = 0.31};
  marker_named(scenario, "T2").place.z_mm = -150.0 * size;
  marker_named(scenario, "T3").dy = {.amplitude = 5.0, .frequency_hz = 0.23, .phase_deg = 40.0};
  return scenario;
}

// Returns thin-line grids from an ink-jet printer, photographed by a phone: lines of 3.5 px at a pitch of 22 px. The
// white paper saturates the sensor.
Scenario ink_jet(double share_of_picture) {
  Scenario scenario;
  const int width = static_cast<int>(4032 * share_of_picture), height = static_cast<int>(3024 * share_of_picture);
  scenario.camera = {.width = width, .height = height, .fx = 3100.0, .fy = 3100.0};
  scenario.camera.cx = 0.5 * width - 0.5 + 4.1;
  scenario.camera.cy = 0.5 * height - 0.5 - 3.3;
  scenario.mount.distance_mm = 704.5;
  scenario.mount.board_x_deg = 3.0;
  scenario.mount.board_y_deg = -4.0;
  scenario.mount.board_z_deg = 1.5;
  draw_poses(scenario.mount, 0.3, 0.0);
  const double s = share_of_picture, x = 458.0 * s - 133.0, y = 343.0 * s - 75.0;
  place_markers(scenario, {x + 65.0, y, 22.0, x, y, 60.0, 0.0});
  SceneMarker& target = marker_named(scenario, "mid");
  target.print.grating->width_mm = 375.0 * s;
  target.print.grating->height_mm = 175.0 * s;
  for (SceneMarker& marker : scenario.markers) {
    marker.print.grating->pitch_mm = 5.0;
    marker.paper_margin_mm = 12.0;
    marker.ink = {.line_share = 0.16, .gain_mm = 0.02, .rough_mm = 0.06, .mottle = 0.05, .grain = 3.0};
  }
  scenario.light.white = 262.0;
  scenario.light.black = 12.0;
  scenario.light.background = 90.0;
  scenario.light.vignetting = 0.1;
  scenario.processing.tone = *tone_named("s-curve:0.3");
  scenario.processing.sharpen_amount = 0.5;
  return scenario;
}

struct Programme {
  std::string_view suffix;
  void (*apply)(Scenario&);
};

constexpr std::array kProgrammes{
    Programme{"spread-1", [](Scenario& s) { draw_poses(s.mount, 1.0, 0.0); }},
    Programme{"orbit-20", [](Scenario& s) { orbit(s, 20.0); }},
    Programme{"orbit-40", [](Scenario& s) { orbit(s, 40.0); }},
    Programme{"travel-5", [](Scenario& s) { travel(s, 5.0); }},
    Programme{"travel-50",
              [](Scenario& s) {
                enlarge(s.camera);
                travel(s, 50.0);
              }},
    Programme{"walk", walk},
    Programme{"six-slip",
              [](Scenario& s) {
                turn(s.mount, kSways[2]);
                add_two_references(s);
                marker_named(s, "NE").dy.knots = {{8.0, 0.0}, {8.1, 1.0}};
              }},
    Programme{"covered",
              [](Scenario& s) {
                turn(s.mount, kSways[2]);
                marker_named(s, "NE").cover.frames = {{40, 60}};
                marker_named(s, "mid").cover.frames = {{90, 100}};
              }},
};

}  // namespace

Track paper_motion() {
  Track track;
  track.knots = {{0, 0}, {2, 1}, {4, 1}, {6, 2}, {8, 2}, {10, 1}, {12, 1}, {14, 0}, {16, 0}};
  return track;
}

const std::vector<BuiltIn>& built_in_scenarios() {
  static const std::vector<BuiltIn> list{
      {"rig-0.1x", "the paper's rig, 4104x1012, camera rotating 0 to 0.1 deg about x"},
      {"rig-1x", "the paper's rig, camera rotating 0 to 1 deg about x"},
      {"rig-1xyz", "the paper's rig, camera rotating 0 to 1 deg about x, y and z"},
      {"rig-8xyz", "the paper's rig, camera rotating -4 to 4 deg about x, y and z"},
      {"small-0.1x", "the small rig, 1024x512, camera rotating 0 to 0.1 deg about x"},
      {"small-1x", "the small rig, camera rotating 0 to 1 deg about x"},
      {"small-1xyz", "the small rig, camera rotating 0 to 1 deg about x, y and z"},
      {"small-still", "the small rig, camera fixed"},
      {"small-spread-1", "the small rig, random camera pose in every frame, -1 to 1 deg about x, y and z"},
      {"small-orbit-20", "the small rig, camera circling the board from -20 to 20 deg"},
      {"small-orbit-40", "the small rig, camera circling the board from -40 to 40 deg"},
      {"small-travel-5", "the small rig, target 30 mm behind the plane, random camera pose, -5 to 5 mm and 1 deg"},
      {"small-travel-50", "the same in a larger image, -50 to 50 mm and 1 deg"},
      {"small-walk", "as small-1xyz, target moving up and down by 60 mm, up to 0.63 pitch per frame"},
      {"small-six-slip", "as small-1xyz with six references, of which NE slips up by 1 mm half way"},
      {"small-covered", "as small-1xyz, NE covered in frames 40 to 59, target covered in frames 90 to 99"},
      {"drone", "a drone 8 m from a wall, 3840x2160, moving 0.5 m and 3 deg on every axis, 60 mm pitch (21 px)"},
      {"ink", "thin-line grids from an ink-jet printer, 4032x3024, as stored by a phone"},
      {"small-ink", "the same with a quarter of the pixels and gratings closer together"},
      {"small-drone", "the same from 4 m with a quarter of the pixels, moving 0.25 m and 3 deg"},
  };
  return list;
}

std::optional<Scenario> built_in(const std::string& name) {
  for (const BuiltIn& entry : built_in_scenarios()) {
    if (entry.name != name) continue;
    if (name.ends_with("ink")) {
      Scenario scenario = ink_jet(name == "ink" ? 1.0 : 0.5);
      scenario.name = name;
      return scenario;
    }
    if (name.ends_with("drone")) {
      Scenario scenario = name == "drone" ? drone(1.0, 1.0) : drone(0.5, 0.42);
      scenario.name = name;
      return scenario;
    }
    Scenario scenario = name.starts_with("small-") ? small_rig() : rig();
    scenario.name = name;
    const std::string programme = name.substr(name.find('-') + 1);
    for (const Sway& sway : kSways) {
      if (programme == sway.suffix) turn(scenario.mount, sway);
    }
    for (const Programme& special : kProgrammes) {
      if (programme == special.suffix) special.apply(scenario);
    }
    return scenario;
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal::simulator
