// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/scenario/settings.h"

#include "moiregauge/simulator/scenario/setting_collector.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

void add_camera(Collector& all, Scenario& s) {
  all.whole("camera.width", s.camera.width);
  all.whole("camera.height", s.camera.height);
  all.number("camera.fx", s.camera.fx);
  all.number("camera.fy", s.camera.fy);
  all.number("camera.cx", s.camera.cx);
  all.number("camera.cy", s.camera.cy);
  all.number("lens.k1", s.camera.k1);
  all.number("lens.k2", s.camera.k2);
  all.number("lens.p1", s.camera.p1);
  all.number("lens.p2", s.camera.p2);
  all.number("lens.k3", s.camera.k3);
  all.number("mount.distance_mm", s.mount.distance_mm);
  all.number("mount.board_x_deg", s.mount.board_x_deg);
  all.number("mount.board_y_deg", s.mount.board_y_deg);
  all.number("mount.board_z_deg", s.mount.board_z_deg);
  all.number("mount.pivot_x_mm", s.mount.pivot_x_mm);
  all.number("mount.pivot_y_mm", s.mount.pivot_y_mm);
  all.number("mount.pivot_z_mm", s.mount.pivot_z_mm);
  all.track("rotation.x", s.mount.rotation_x);
  all.track("rotation.y", s.mount.rotation_y);
  all.track("rotation.z", s.mount.rotation_z);
  all.track("shift.x", s.mount.shift_x);
  all.track("shift.y", s.mount.shift_y);
  all.track("shift.z", s.mount.shift_z);
}

void add_light(Collector& all, Scenario& s) {
  all.number("light.white", s.light.white);
  all.number("light.black", s.light.black);
  all.number("light.background", s.light.background);
  all.number("light.texture", s.light.texture);
  all.number("light.vignetting", s.light.vignetting);
  all.track("light.slope_x", s.light.slope_x);
  all.track("light.slope_y", s.light.slope_y);
  all.number("noise.sigma", s.sensor.noise_sigma);
  all.number("noise.gain", s.sensor.noise_gain);
  all.number("sensor.psf_sigma_px", s.sensor.psf_sigma_px);
  all.whole("sensor.bits", s.sensor.bits);
  all.number("sensor.fps", s.sensor.fps);
  all.number("sensor.exposure_s", s.sensor.exposure_s);
  all.number("sensor.readout_s", s.sensor.readout_s);
  all.whole("decoys", s.decoys);
  all.whole("frames", s.frames);
  all.whole("seed", s.seed);
}

void add_processing(Collector& all, Scenario& s) {
  Processing& p = s.processing;
  all.text("processing.tone", "one of linear, srgb, bt709, gamma:2.2, s-curve, s-curve:0.4",
           [&p](const std::string& words) {
             const auto tone = tone_named(words);
             if (tone) p.tone = *tone;
             return tone.has_value();
           });
  all.whole("processing.median_px", p.median_px);
  all.number("processing.bilateral_px", p.bilateral_px);
  all.number("processing.bilateral_grey", p.bilateral_grey);
  all.number("processing.local_tone", p.local_tone.strength);
  all.whole("processing.local_tone_tile_px", p.local_tone.tile_px);
  all.number("processing.local_tone_slope", p.local_tone.most_slope);
  all.number("processing.sharpen", p.sharpen_amount);
  all.number("processing.sharpen_radius_px", p.sharpen_radius_px);
  all.number("processing.low_pass", p.low_pass);
  all.number("processing.pixel_size", p.pixel_size);
  all.whole("processing.average_frames", p.average_frames);
  all.number("processing.recursion", p.recursion);
  all.number("processing.motion_grey", p.motion_grey);
}

void add_site_errors(Collector& all, Scenario& s) {
  all.number("known_to.position_mm", s.known_to.position_mm);
  all.number("known_to.rotation_deg", [&s](double value) { s.known_to.rotation_rad = radians_from_degrees(value); });
  all.number("known_to.height_mm", s.known_to.height_mm);
  all.number("known_to.print_scale", s.known_to.print_scale);
  // Uncertainties of a survey with a total station, and of a printer checked with a ruler.
  all.text("site.surveyed", "true or false", [&s](const std::string& word) {
    s.known_to = KnownTo{};
    if (word == "true")
      s.known_to = {
          .position_mm = 0.01, .rotation_rad = radians_from_degrees(0.001), .height_mm = 0.01, .print_scale = 0.0005};
    return word == "true" || word == "false";
  });
  all.flag("truth.draw_known_to", {&s.draw.position, &s.draw.rotation, &s.draw.height, &s.draw.print_scale});
  all.flag("truth.draw_position", {&s.draw.position});
  all.flag("truth.draw_rotation", {&s.draw.rotation});
  all.flag("truth.draw_height", {&s.draw.height});
  all.flag("truth.draw_print_scale", {&s.draw.print_scale});
  all.whole("truth.seed", s.draw.seed);
}

std::function<bool(const std::string&)> pattern_setter(const std::vector<SceneMarker*>& markers) {
  return [markers](const std::string& word) {
    const auto pattern = pattern_named(word);
    if (!pattern || *pattern == Pattern::kAuto) return false;
    for (SceneMarker* marker : markers) {
      if (marker->print.grating) marker->print.grating->pattern = *pattern;
    }
    return true;
  };
}

constexpr const char* kPatterns = "one of grid, squares, dots, lines-x, lines-y, checkerboard, cosine";

// Adds the settings of [grating], which apply to all gratings.
void add_print(Collector& all, Scenario& s) {
  std::vector<SceneMarker*> markers;
  std::vector<bool*> inverted;
  for (SceneMarker& marker : s.markers) {
    markers.push_back(&marker);
    inverted.push_back(&marker.inverted);
  }
  const auto for_each_grating = [markers](auto change) {
    return [markers, change](double value) {
      for (SceneMarker* marker : markers) {
        if (marker->print.grating) change(*marker->print.grating, value);
      }
    };
  };
  all.number("grating.pitch_mm", for_each_grating([](Grating& g, double value) { g.pitch_mm = value; }));
  all.number("grating.angle_deg",
             for_each_grating([](Grating& g, double v) { g.angle_rad = radians_from_degrees(v); }));
  all.text("grating.pattern", kPatterns, pattern_setter(markers));
  all.flag("grating.inverted", inverted);
}

Circle& circle_in(SceneMarker& m) { return m.print.circle ? *m.print.circle : m.print.circle.emplace(); }
Grating& grating_in(SceneMarker& m) {
  if (!m.print.grating) m.print.grating.emplace().pattern = Pattern::kGrid;
  return *m.print.grating;
}

void add_marker(Collector& all, SceneMarker& m) {
  const std::string name = "marker." + m.print.name + ".";
  all.pair(name + "circle_mm", [&m](double x, double y) { circle_in(m).centre = {x, y}; });
  all.number(name + "circle_diameter_mm", [&m](double value) { circle_in(m).diameter_mm = value; });
  all.pair(name + "grating_mm", [&m](double x, double y) { grating_in(m).centre = {x, y}; });
  all.pair(name + "grating_size_mm", [&m](double x, double y) {
    grating_in(m).width_mm = x;
    grating_in(m).height_mm = y;
  });
  all.number(name + "pitch_mm", [&m](double value) { grating_in(m).pitch_mm = value; });
  all.number(name + "angle_deg", [&m](double value) { grating_in(m).angle_rad = radians_from_degrees(value); });
  all.text(name + "pattern", kPatterns, pattern_setter({&m}));
  all.number(name + "z_mm", [&m](double value) { m.print.z_mm = value; });
  all.text(name + "role", "reference or target", [&m](const std::string& word) {
    m.print.role = word == "target" ? Role::kTarget : Role::kReference;
    return word == "target" || word == "reference";
  });
  all.flag(name + "inverted", {&m.inverted});
  all.flag(name + "listed", {&m.listed});
  all.number(name + "paper_margin_mm", m.paper_margin_mm);
  all.number(name + "place.x_mm", m.place.x_mm);
  all.number(name + "place.y_mm", m.place.y_mm);
  all.number(name + "place.z_mm", m.place.z_mm);
  all.number(name + "place.rotation_deg", m.place.rotation_deg);
  all.number(name + "place.print_scale", m.place.print_scale);
  add_faults_of(all, m);
  all.track(name + "dx", m.dx);
  all.track(name + "dy", m.dy);
  all.track(name + "dz", m.dz);
}

}  // namespace

std::vector<Setting> settings_of(Scenario& scenario) {
  Collector all;
  add_camera(all, scenario);
  add_light(all, scenario);
  add_processing(all, scenario);
  add_site_errors(all, scenario);
  add_faults(all, scenario);
  add_print(all, scenario);
  for (SceneMarker& marker : scenario.markers) add_marker(all, marker);
  return std::move(all.settings);
}

}  // namespace moiregauge::internal::simulator
