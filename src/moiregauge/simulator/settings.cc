// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/settings.h"

#include <cmath>
#include <cstdlib>

#include "moiregauge/units/units.h"

namespace moiregauge::simulator {
namespace {

// "[[0, 1], [2, 3]]" and "0 1 2 3" alike; nothing if a word is no finite number.
std::optional<std::vector<double>> numbers_in(std::string text) {
  for (char& c : text) {
    if (c == '[' || c == ']' || c == ',') c = ' ';
  }
  std::vector<double> numbers;
  const char* at = text.c_str();
  while (true) {
    while (*at == ' ') ++at;
    if (*at == '\0') return numbers;
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at || (*end != ' ' && *end != '\0') || !std::isfinite(numbers.back())) return std::nullopt;
    at = end;
  }
}

std::optional<double> number_in(const std::string& text) {
  const auto numbers = numbers_in(text);
  return numbers && numbers->size() == 1 ? std::optional(numbers->front()) : std::nullopt;
}

class Collector {
 public:
  std::vector<Setting> settings;

  void number(const std::string& name, double& value) {
    settings.push_back({name, "a number", [&value](const std::string& text) {
                          const auto read = number_in(text);
                          if (read) value = *read;
                          return read.has_value();
                        }});
  }
  template <typename Whole>
  void whole(const std::string& name, Whole& value) {
    settings.push_back({name, "a whole number of 0 or more", [&value](const std::string& text) {
                          const auto read = number_in(text);
                          if (!read || *read < 0.0 || *read > 2e9 || *read != std::floor(*read)) return false;
                          value = static_cast<Whole>(*read);
                          return true;
                        }});
  }
  void flag(const std::string& name, std::vector<bool*> values) {
    settings.push_back({name, "true or false", [values](const std::string& text) {
                          if (text != "true" && text != "false") return false;
                          for (bool* value : values) *value = text == "true";
                          return true;
                        }});
  }
  void pair(const std::string& name, std::function<void(double, double)> take) {
    settings.push_back({name, "two numbers", [take](const std::string& text) {
                          const auto read = numbers_in(text);
                          if (!read || read->size() != 2) return false;
                          take((*read)[0], (*read)[1]);
                          return true;
                        }});
  }
  void number(const std::string& name, std::function<void(double)> take) {
    settings.push_back({name, "a number", [take](const std::string& text) {
                          const auto read = number_in(text);
                          if (read) take(*read);
                          return read.has_value();
                        }});
  }
  void text(const std::string& name, const std::string& kind, std::function<bool(const std::string&)> take) {
    settings.push_back({name, kind, std::move(take)});
  }
  void frames(const std::string& name, std::vector<FrameSpan>& spans) {
    text(name, "pairs of whole numbers, first frame and the one after the last", [&spans](const std::string& words) {
      const auto read = numbers_in(words);
      if (!read || read->size() % 2 != 0) return false;
      std::vector<FrameSpan> taken;
      for (std::size_t i = 0; i < read->size(); i += 2) {
        const double from = (*read)[i], to = (*read)[i + 1];
        if (from < 0.0 || to < from || to > 2e9 || from != std::floor(from) || to != std::floor(to)) return false;
        taken.push_back({static_cast<long>(from), static_cast<long>(to)});
      }
      spans = taken;
      return true;
    });
  }
  void track(const std::string& name, Track& track) {
    number(name + ".scale", track.scale);
    number(name + ".offset", track.offset);
    number(name + ".amplitude", track.amplitude);
    number(name + ".frequency_hz", track.frequency_hz);
    number(name + ".phase_deg", track.phase_deg);
    number(name + ".random", track.random);
    number(name + ".random_step_s", track.random_step_s);
    whole(name + ".random_seed", track.random_seed);
    text(name + ".knots", "pairs of time and value, times rising", [&track](const std::string& words) {
      const auto read = numbers_in(words);
      if (!read || read->size() % 2 != 0) return false;
      std::vector<Knot> knots;
      for (std::size_t i = 0; i < read->size(); i += 2) {
        if (!knots.empty() && (*read)[i] <= knots.back().time_s) return false;
        knots.push_back({(*read)[i], (*read)[i + 1]});
      }
      track.knots = knots;
      return true;
    });
  }
};

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
  all.number("light.slope_x", s.light.slope_x);
  all.number("light.slope_y", s.light.slope_y);
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

void add_site_errors(Collector& all, Scenario& s) {
  all.number("known_to.position_mm", s.known_to.position_mm);
  all.number("known_to.rotation_deg", [&s](double value) { s.known_to.rotation_rad = radians_from_degrees(value); });
  all.number("known_to.height_mm", s.known_to.height_mm);
  all.number("known_to.print_scale", s.known_to.print_scale);
  all.flag("truth.draw_known_to", {&s.draw.position, &s.draw.rotation, &s.draw.height, &s.draw.print_scale});
  all.flag("truth.draw_position", {&s.draw.position});
  all.flag("truth.draw_rotation", {&s.draw.rotation});
  all.flag("truth.draw_height", {&s.draw.height});
  all.flag("truth.draw_print_scale", {&s.draw.print_scale});
  all.whole("truth.seed", s.draw.seed);
}

std::function<bool(const std::string&)> pattern_setter(std::vector<SceneMarker*> markers) {
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

// What [grating] says holds for every grating there is.
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
  all.frames(name + "cover.frames", m.cover.frames);
  all.number(name + "cover.share", m.cover.share);
  all.number(name + "cover.grey", m.cover.grey);
  all.track(name + "dx", m.dx);
  all.track(name + "dy", m.dy);
  all.track(name + "dz", m.dz);
}

}  // namespace

std::vector<Setting> settings_of(Scenario& scenario) {
  Collector all;
  add_camera(all, scenario);
  add_light(all, scenario);
  add_site_errors(all, scenario);
  add_print(all, scenario);
  for (SceneMarker& marker : scenario.markers) add_marker(all, marker);
  return std::move(all.settings);
}

}  // namespace moiregauge::simulator
