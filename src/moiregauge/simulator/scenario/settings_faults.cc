// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "moiregauge/simulator/scenario/setting_collector.h"

namespace moiregauge::internal::simulator {
namespace {

void add_optics(Collector& all, Scenario& s) {
  all.track("lens.zoom", s.optics.zoom);
  all.track("lens.shift_x", s.optics.shift_x);
  all.track("lens.shift_y", s.optics.shift_y);
  all.number("lens.focus_mm", s.optics.focus_mm);
  all.number("lens.aperture_mm", s.optics.aperture_mm);
  all.track("sensor.defocus_px", s.sensor.defocus_px);
  all.track("sensor.defocus_disc_px", s.sensor.defocus_disc_px);
  all.number("sensor.gamma", s.sensor.gamma);
  all.flag("sensor.interlaced", {&s.sensor.interlaced});
  all.number("noise.row", s.sensor.row_noise);
  all.track("light.flicker", s.light.flicker);
  all.number("haze.rms_mm", s.haze.rms_mm);
  all.number("haze.step_s", s.haze.step_s);
}

void add_timing(Collector& all, Scenario& s) {
  all.number("timing.jitter_s", s.timing.jitter_s);
  all.number("timing.stamp_jitter_s", s.timing.stamp_jitter_s);
  all.flag("timing.nominal_stamps", {&s.timing.nominal_stamps});
  all.frames("timing.dropped", s.timing.dropped);
  all.frames("timing.repeated", s.timing.repeated);
}

void add_ink(Collector& all, const std::string& name, const std::vector<Ink*>& inks) {
  const auto add = [&](const char* what, double Ink::*member) {
    all.number(name + what, [inks, member](double value) {
      for (Ink* ink : inks) ink->*member = value;
    });
  };
  add("line_share", &Ink::line_share);
  add("gain_mm", &Ink::gain_mm);
  add("rough_mm", &Ink::rough_mm);
  add("rough_length_mm", &Ink::rough_length_mm);
  add("mottle", &Ink::mottle);
  add("mottle_length_mm", &Ink::mottle_length_mm);
  add("grain", &Ink::grain);
  add("grain_length_mm", &Ink::grain_length_mm);
}

// Adds settings that apply to all sheets, as from one printer.
void add_prints(Collector& all, Scenario& s) {
  std::vector<Ink*> inks;
  for (SceneMarker& marker : s.markers) inks.push_back(&marker.ink);
  add_ink(all, "ink.", inks);
  all.number("print.scale", [&s](double value) {
    for (SceneMarker& marker : s.markers) marker.place.print_scale = value;
  });
  all.number("print.stretch_x", [&s](double value) {
    for (SceneMarker& marker : s.markers) marker.place.stretch_x = value;
  });
}

// Adds the setting of exchanged markers: "NW NE SW SE" exchanges NW with NE, and SW with SE.
void add_exchanges(Collector& all, Scenario& s) {
  all.text("site.exchanged", "pairs of marker names", [&s](const std::string& words) {
    std::istringstream in(words);
    std::vector<std::string> names;
    for (std::string name; in >> name;) names.push_back(name);
    const auto is_known = [&](const std::string& name) {
      return std::any_of(s.markers.begin(), s.markers.end(), [&](const auto& m) { return m.print.name == name; });
    };
    if (names.size() % 2 != 0 || !std::all_of(names.begin(), names.end(), is_known)) return false;
    s.site_errors.exchanged.clear();
    for (std::size_t i = 0; i < names.size(); i += 2) s.site_errors.exchanged.emplace_back(names[i], names[i + 1]);
    return true;
  });
  all.flag("site.mirrored", {&s.site_errors.mirrored});
}

}  // namespace

void add_faults(Collector& all, Scenario& scenario) {
  add_optics(all, scenario);
  add_timing(all, scenario);
  add_prints(all, scenario);
  add_exchanges(all, scenario);
}

void add_faults_of(Collector& all, SceneMarker& m) {
  const std::string name = "marker." + m.print.name + ".";
  all.number(name + "place.stretch_x", m.place.stretch_x);
  add_ink(all, name + "ink.", {&m.ink});
  all.frames(name + "cover.frames", m.cover.frames);
  all.number(name + "cover.share", m.cover.share);
  all.number(name + "cover.height_share", m.cover.height_share);
  all.number(name + "cover.grey", m.cover.grey);
  all.number(name + "cover.texture", m.cover.texture);
  all.number(name + "cover.opacity", m.cover.opacity);
  all.track(name + "cover.x_mm", m.cover.x_mm);
  all.track(name + "cover.y_mm", m.cover.y_mm);
  all.track(name + "glare.grey", m.glare.grey);
  all.track(name + "glare.x_mm", m.glare.x_mm);
  all.track(name + "glare.y_mm", m.glare.y_mm);
  all.number(name + "glare.sigma_mm", m.glare.sigma_mm);
  all.track(name + "fold_mm", m.fold_mm);
  all.track(name + "wander_x", m.wander_x);
  all.track(name + "wander_y", m.wander_y);
}

}  // namespace moiregauge::internal::simulator
