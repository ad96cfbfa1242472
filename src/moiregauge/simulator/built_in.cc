// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/built_in.h"

#include <array>

namespace moiregauge::simulator {
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

}  // namespace

Track paper_motion() {
  Track track;
  track.knots = {{0, 0}, {2, 1}, {4, 1}, {6, 2}, {8, 2}, {10, 1}, {12, 1}, {14, 0}, {16, 0}};
  return track;
}

const std::vector<BuiltIn>& built_in_scenarios() {
  static const std::vector<BuiltIn> list{
      {"rig-0.1x", "the paper's rig, 4104x1012, camera turning 0 to 0.1 deg about x"},
      {"rig-1x", "the paper's rig, camera turning 0 to 1 deg about x"},
      {"rig-1xyz", "the paper's rig, camera turning 0 to 1 deg about x, y and z"},
      {"rig-8xyz", "the paper's rig, camera turning -4 to 4 deg about x, y and z"},
      {"small-0.1x", "the small rig, 1024x512, camera turning 0 to 0.1 deg about x"},
      {"small-1x", "the small rig, camera turning 0 to 1 deg about x"},
      {"small-1xyz", "the small rig, camera turning 0 to 1 deg about x, y and z"},
  };
  return list;
}

std::optional<Scenario> built_in(const std::string& name) {
  for (const BuiltIn& entry : built_in_scenarios()) {
    if (entry.name != name) continue;
    const bool is_small = name.starts_with("small-");
    Scenario scenario = is_small ? small_rig() : rig();
    scenario.name = name;
    for (const Sway& sway : kSways) {
      if (name.substr(name.find('-') + 1) != sway.suffix) continue;
      Track turn;
      turn.knots = {{0.0, sway.from_deg}, {kRunLength_s, sway.to_deg}};
      scenario.mount.rotation_x = turn;
      if (sway.all_axes) scenario.mount.rotation_y = scenario.mount.rotation_z = turn;
    }
    return scenario;
  }
  return std::nullopt;
}

}  // namespace moiregauge::simulator
