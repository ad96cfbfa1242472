// SPDX-License-Identifier: Apache-2.0
#include "common/crowded_scene.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::test {
namespace {

using simulator::Scenario;
using simulator::SceneMarker;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  bool one_in_two() { return (engine_() & 1U) != 0; }
  // Returns a nearly standard normal number: the sum of four uniform ones, each from 16 bits of one draw.
  double normal() {
    const std::uint64_t bits = engine_();
    double sum = 0.0;
    for (unsigned i = 0; i < 4; ++i) sum += static_cast<double>((bits >> (16U * i)) & 0xffffU);
    return (sum / 65536.0 - 2.0 + 2.0 / 65536.0) * std::sqrt(3.0);
  }

 private:
  std::mt19937_64 engine_;
};

// Bounding box of a sheet of paper, along the board's axes.
struct Sheet {
  double x0, y0, x1, y1;
};

Sheet sheet_of(const SceneMarker& marker) {
  Sheet s{1e9, 1e9, -1e9, -1e9};
  const auto cover = [&](BoardPoint c, double half) {
    s = {std::min(s.x0, c.x - half), std::min(s.y0, c.y - half), std::max(s.x1, c.x + half),
         std::max(s.y1, c.y + half)};
  };
  const double margin = marker.paper_margin_mm;
  if (marker.print.circle) cover(marker.print.circle->centre, 0.5 * marker.print.circle->diameter_mm + margin);
  if (const auto& g = marker.print.grating) {
    const double turned = std::abs(std::cos(g->angle_rad)) + std::abs(std::sin(g->angle_rad));
    cover(g->centre, 0.5 * turned * std::max(g->width_mm, g->height_mm) + margin);
  }
  return s;
}

bool overlap(const Sheet& a, const Sheet& b) { return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1; }

std::vector<ImagePoint> corners(const Scenario& scenario, const Sheet& s, long frame) {
  std::vector<ImagePoint> out;
  for (const BoardPoint p : {BoardPoint{s.x0, s.y0}, {s.x1, s.y0}, {s.x1, s.y1}, {s.x0, s.y1}})
    out.push_back(project(scenario, frame, p));
  return out;
}

bool in_picture(const Scenario& scenario, const Sheet& sheet) {
  for (const long frame : {0L, kMovedFrame}) {
    for (const ImagePoint p : corners(scenario, sheet, frame)) {
      if (!(p.x > 12 && p.y > 12 && p.x < scenario.camera.width - 13 && p.y < scenario.camera.height - 13))
        return false;
    }
  }
  return true;
}

simulator::Track up_to(double value) {
  simulator::Track track;
  track.knots = {{0.0, 0.0}, {0.9, value}, {1.5, value}};
  return track;
}

void point_the_camera(Scenario& s, Dice& dice, double& roll_deg) {
  do {
    roll_deg = dice.one_in_two() ? dice.between(-15.0, 15.0) : dice.between(-85.0, 85.0);
    s.mount.board_x_deg = dice.between(-20.0, 20.0);
    s.mount.board_y_deg = dice.between(-20.0, 20.0);
    s.mount.board_z_deg = roll_deg;
    s.mount.distance_mm = dice.between(1200.0, 2600.0);
    s.mount.rotation_x = up_to(dice.between(-0.2, 0.2));
    s.mount.rotation_y = up_to(dice.between(-0.2, 0.2));
    s.mount.rotation_z = up_to(dice.between(-0.5, 0.5));
  } while (!std::all_of(s.markers.begin(), s.markers.end(), [&](const auto& m) { return in_picture(s, sheet_of(m)); }));
}

// Adds a marker at a random free position in the image. Returns false after 400 tries.
bool scatter(Scenario& s, Dice& dice, SceneMarker marker) {
  marker.listed = false;
  for (int tries = 0; tries < 400; ++tries) {
    const double reach = 0.5 * s.camera.width / s.camera.fx * s.mount.distance_mm * 1.1;
    const BoardPoint at{dice.between(-reach, reach), dice.between(-reach, reach)};
    if (marker.print.circle) marker.print.circle->centre = at;
    if (marker.print.grating) marker.print.grating->centre = at;
    const Sheet sheet = sheet_of(marker);
    if (!in_picture(s, sheet)) continue;
    if (std::any_of(s.markers.begin(), s.markers.end(), [&](const auto& m) { return overlap(sheet, sheet_of(m)); }))
      continue;
    s.markers.push_back(marker);
    return true;
  }
  return false;
}

std::vector<PaintedEllipse> painted(const Scenario& s, Dice& dice) {
  std::vector<PaintedEllipse> out;
  for (int tries = 0; tries < 400 && out.size() < 4; ++tries) {
    PaintedEllipse e;
    e.centre = {dice.between(30.0, s.camera.width - 30.0), dice.between(30.0, s.camera.height - 30.0)};
    e.half_length = dice.between(8.0, 25.0);
    e.half_width = e.half_length * dice.between(0.45, 0.8);
    e.angle_rad = dice.between(0.0, kPi);
    e.grey = dice.one_in_two() ? s.light.black : s.light.white;
    const double clear = e.half_length + 6.0;
    const bool on_a_sheet = std::any_of(s.markers.begin(), s.markers.end(), [&](const SceneMarker& m) {
      double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
      for (const long frame : {0L, kMovedFrame}) {
        for (const ImagePoint p : corners(s, sheet_of(m), frame)) {
          x0 = std::min(x0, p.x), y0 = std::min(y0, p.y), x1 = std::max(x1, p.x), y1 = std::max(y1, p.y);
        }
      }
      return e.centre.x > x0 - clear && e.centre.x < x1 + clear && e.centre.y > y0 - clear && e.centre.y < y1 + clear;
    });
    if (!on_a_sheet) out.push_back(e);
  }
  return out;
}

// Returns the share of a pixel inside the ellipse. The edge is as blurred as those of the image.
double inside(const PaintedEllipse& e, double x, double y) {
  const double c = std::cos(e.angle_rad), s = std::sin(e.angle_rad), dx = x - e.centre.x, dy = y - e.centre.y;
  const double u = (c * dx + s * dy) / e.half_length, v = (-s * dx + c * dy) / e.half_width;
  const double r = std::hypot(u, v);
  if (r < 0.1) return 1.0;
  const double slope = std::hypot(u / e.half_length, v / e.half_width) / r;  // derivative of r, per px
  return 0.5 * std::erfc((r - 1.0) / slope / 0.76 / std::sqrt(2.0));
}

}  // namespace

CrowdedScene crowded_scene(std::uint64_t seed, Fault fault) {
  Dice dice(seed);
  CrowdedScene scene;
  Scenario& s = scene.scenario = *simulator::built_in("small-0.1x");
  s.seed = seed;
  s.markers.back().dx = up_to(0.6);
  s.markers.back().dy = up_to(1.7);
  point_the_camera(s, dice, scene.roll_deg);
  s.light.slope_x.offset = dice.between(-0.25, 0.25);
  s.light.slope_y.offset = dice.between(-0.25, 0.25);
  s.light.vignetting = dice.between(0.0, 0.25);
  s.sensor.noise_sigma = dice.between(0.5, 3.0);
  SceneMarker spare;
  const double side = dice.between(30.0, 45.0), turn = dice.one_in_two() ? 0.0 : dice.between(-kPi / 4, kPi / 4);
  spare.print.grating = Grating{.centre = {},
                                .width_mm = side,
                                .height_mm = side,
                                .pitch_mm = 10.0,
                                .angle_rad = turn,
                                .pattern = Pattern::kGrid};
  spare.print.name = "spare";
  (void)scatter(s, dice, spare);
  for (int i = 0; i < 6; ++i) {
    SceneMarker decoy;
    decoy.print.name = "look-alike";
    decoy.print.circle = Circle{{}, i < 4 ? 16.0 : 16.0 * dice.between(0.8, 1.25)};
    decoy.paper_margin_mm = dice.between(3.0, 10.0);
    (void)scatter(s, dice, decoy);
  }
  scene.ellipses = painted(s, dice);
  scene.site = simulator::site_of(s);
  if (fault == Fault::kCircleMissing) s.markers[seed % 4].print.circle.reset();
  return scene;
}

Image<std::uint8_t> picture_of(const CrowdedScene& scene, long frame) {
  Image<double> light = render_ideal(scene.scenario, frame, {0, simulator::Area::kWholeFrame});
  for (const PaintedEllipse& e : scene.ellipses) {
    const int reach = static_cast<int>(e.half_length) + 4, x0 = static_cast<int>(e.centre.x),
              y0 = static_cast<int>(e.centre.y);
    for (int y = std::max(0, y0 - reach); y < std::min(light.height(), y0 + reach); ++y) {
      for (int x = std::max(0, x0 - reach); x < std::min(light.width(), x0 + reach); ++x) {
        const double share = inside(e, x, y);
        light.at(x, y) += share * (e.grey - light.at(x, y));
      }
    }
  }
  Dice dice(scene.scenario.seed * 1000003U + static_cast<std::uint64_t>(frame));
  Image<std::uint8_t> out(light.width(), light.height());
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x) {
      const double grey = light.at(x, y) + scene.scenario.sensor.noise_sigma * dice.normal();
      out.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
  }
  return out;
}

}  // namespace moiregauge::internal::test
