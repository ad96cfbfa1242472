// SPDX-License-Identifier: Apache-2.0
// Faults in front of the camera: on the sheets, with them, and in the site file.
#include <cmath>

#include "faults/fault_modes.h"

namespace moiregauge::internal::faults {

namespace {
// --- in front of the sheets

// A strip with `share` of the sheet's width moves across it.
void sweep(SceneMarker& m, int seed, double share, double grey, double opacity) {
  cover(m, seed, share, 1.0);
  m.cover.grey = grey;
  m.cover.opacity = opacity;
  m.cover.x_mm.knots = {{3.0, -30.0}, {9.0, 60.0}};
}

}  // namespace

void add_covers(std::vector<Mode>& all) {
  add(all, "corner of the target", "something opaque before a corner of the target's sheet", "{} of each side",
      {0.2, 0.35, 0.5, 0.7}, [](Sequence& q, int seed, double s) { cover(target(q), seed, s, s); });
  add(all, "corner of a reference", "the same before a reference", "{} of each side", {0.2, 0.35, 0.5, 0.7},
      [](Sequence& q, int seed, double s) { cover(reference(q, seed), seed, s, s); });
  add(all, "moving cover", "an opaque strip crosses the target (even seeds) or a reference", "{} of the width",
      {0.1, 0.25, 0.5}, [](Sequence& q, int seed, double s) {
        sweep(seed % 4 < 2 ? target(q) : reference(q, seed), seed, s, 60.0, 1.0);
      });
  add(all, "shadow", "a shadow's edge crosses the target or a reference", "takes {}", {0.1, 0.3, 0.6},
      [](Sequence& q, int seed, double s) { sweep(seed % 4 < 2 ? target(q) : reference(q, seed), seed, 0.6, 0.0, s); });
}

void add_glare(std::vector<Mode>& all) {
  const auto spot = [](SceneMarker& m, int seed, double sigma_mm, double grey) {
    m.glare.grey.knots = step(seed, grey);
    m.glare.sigma_mm = sigma_mm;
    m.glare.x_mm.offset = 4.0 * std::sin(seed);
    m.glare.y_mm.offset = 4.0 * std::cos(2.0 * seed);
  };
  add(all, "glare, small", "a lamp's spot in the target (even seeds) or a reference, sigma 3 mm", "{} grey levels",
      {30, 80, 200},
      [spot](Sequence& q, int seed, double s) { spot(seed % 4 < 2 ? target(q) : reference(q, seed), seed, 3.0, s); });
  add(all, "glare, wide", "the same, sigma 12 mm", "{} grey levels", {30, 80, 200},
      [spot](Sequence& q, int seed, double s) { spot(seed % 4 < 2 ? target(q) : reference(q, seed), seed, 12.0, s); });
}

// --- gratings and positions

void add_prints(std::vector<Mode>& all) {
  add(all, "print scale, as stated", "every print drawn as wrong as known_to says", "{}", {0.002, 0.005, 0.01},
      [](Sequence& q, int, double s) { q.scenario.known_to.print_scale = s; });
  add(all, "print scale of all, as stated", "every print too large by what known_to says", "{}", {0.002, 0.005, 0.01},
      [](Sequence& q, int seed, double s) {
        q.scenario.known_to.print_scale = s;
        q.scenario.draw.print_scale = false;
        for (SceneMarker& m : q.scenario.markers) m.place.print_scale = seed % 4 < 2 ? s : -s;
      });
  const auto too_large = [](double scale, bool all_prints) {
    return Mode::Strength{fmt::format("{}: {}", all_prints ? "all" : "the target's", scale), [=](Sequence& q, int) {
                            for (SceneMarker& m : q.scenario.markers) {
                              if (all_prints || m.print.role == Role::kTarget) m.place.print_scale = scale;
                            }
                          }};
  };
  all.push_back({"print scale, unstated",
                 "prints too large by 10 to 60 times what known_to says (0.0005)",
                 false,
                 {too_large(0.005, false), too_large(0.01, false), too_large(0.03, false), too_large(0.005, true),
                  too_large(0.01, true), too_large(0.03, true)}});
  all.back().stated_by_site = true;
  add(all, "print stretched", "every print too long along x", "{}", {0.002, 0.01, 0.03},
      [](Sequence& q, int, double s) {
        for (SceneMarker& m : q.scenario.markers) m.place.stretch_x = s;
      });
  add(all, "fine pitch", "pitch in the picture", "{} px", {4.0, 3.0, 2.6, 2.3, 2.1, 1.7},
      [](Sequence& q, int, double s) {
        for (SceneMarker& m : q.scenario.markers) m.print.grating->pitch_mm = s / kPxPerMm;
      });
  add(all, "fold, target", "half of the target's sheet slips", "{} mm", {0.05, 0.3, 1.0},
      [](Sequence& q, int seed, double s) { target(q).fold_mm.knots = step(seed, s); });
  add(all, "fold, reference", "half of a reference's sheet slips", "{} mm", {0.05, 0.3, 1.0},
      [](Sequence& q, int seed, double s) { reference(q, seed).fold_mm.knots = step(seed, s); });
  add(all, "target off the plane", "by an unstated height", "{} mm", {-40, -10, 15, 50},
      [](Sequence& q, int, double s) { target(q).place.z_mm = s; });
  add(all, "target comes nearer", "total approach over the recording", "{} mm", {1, 5, 20},
      [](Sequence& q, int, double s) {
        target(q).dz.knots = {{0.0, 0.0}, {9.0, s}};
      });
  add(all, "reference off the plane", "by a height of which known_to knows nothing (3 mm)", "{} mm", {-30, 15, 30},
      [](Sequence& q, int seed, double s) { reference(q, seed).place.z_mm = s; });
}

void add_moves(std::vector<Mode>& all) {
  const auto slip = [](Sequence& q, int seed, double s) {
    (seed % 4 < 2 ? reference(q, seed).dy : reference(q, seed).dx).knots = step(seed, s);
  };
  const auto creep = [](Sequence& q, int seed, double s) {
    (seed % 4 < 2 ? reference(q, seed).dy : reference(q, seed).dx).knots = {{0.0, 0.0}, {9.0, s}};
  };
  // The layout depends on the seed: even seeds have four references.
  const auto of = [](int references, const Change& change) -> Change {
    return [references, change](Sequence& q, int seed, double s) {
      q.scenario = scene_of(references == 4 ? 2 * seed : 2 * seed + 1);
      change(q, seed, s);
    };
  };
  const std::initializer_list<double> ways{0.03, 0.1, 0.5, 3.0};
  add(all, "one of six slips", "a step of one of six references", "{} mm", ways, of(6, slip));
  add(all, "one of four slips", "a step of one of four references", "{} mm", ways, of(4, slip));
  add(all, "one of six creeps", "slowly over the recording", "{} mm", ways, of(6, creep));
  add(all, "one of four creeps", "slowly over the recording", "{} mm", ways, of(4, creep));
  add(all, "target jumps", "from one frame to the next", "{} mm", {4.9, 5.1, 9.0, 10.0, 15.0},
      [](Sequence& q, int seed, double s) {
        (seed % 2 == 0 ? target(q).dy : target(q).dx).knots = {{3.4, 0.0}, {3.6, s}};
      });
  add(all, "leaves the picture", "the camera turns away", "{} deg", {0.5, 1.5, 4.0},
      [](Sequence& q, int seed, double s) {
        auto& mount = q.scenario.mount;
        (seed % 2 == 0 ? mount.rotation_y : mount.rotation_x).knots = {{2.0, 0.0}, {9.0, 2.0 * s}};
      });
}

// --- identification

void add_identity(std::vector<Mode>& all) {
  add(all, "look-alikes", "circles distributed over the background", "{:.0f} of them", {10, 40, 100},
      [](Sequence& q, int, double s) { q.scenario.decoys = static_cast<int>(s); });
  add(all, "second target", "an unlisted copy of the target next to it", "{} mm away", {-62, 62},
      [](Sequence& q, int, double s) {
        SceneMarker copy = target(q);
        copy.print.name = "copy";
        copy.listed = false;
        copy.print.grating->centre.y += s;
        copy.paper_margin_mm = 5.0;
        q.scenario.camera.height = 768;
        q.scenario.camera.cy = 383.5;
        q.scenario.markers.push_back(copy);
      });
  all.push_back(
      {"wrong site",
       "site.toml states wrong marker positions",
       false,
       {{"two references exchanged",
         [](Sequence& q, int) {
           q.scenario.site_errors.exchanged = {{"NW", "SE"}};
         }},
        {"a reference and the target exchanged",
         [](Sequence& q, int) {
           q.scenario.site_errors.exchanged = {{"NE", "mid"}};
         }},
        {"mirrored", [](Sequence& q, int) { q.scenario.site_errors.mirrored = true; }},
        {"a reference 10 mm (a pitch) from its stated position",
         [](Sequence& q, int seed) { reference(q, seed).place.x_mm = 10.0; }},
        {"a reference 5 mm from its stated position",
         [](Sequence& q, int seed) { reference(q, seed).place.y_mm = 5.0; }},
        {"a reference 30 mm from its stated position",
         [](Sequence& q, int seed) { reference(q, seed).place.x_mm = seed % 2 == 0 ? 30.0 : -30.0; }},
        {"the target 10 mm from its stated position", [](Sequence& q, int) { target(q).place.x_mm = 10.0; }},
        {"the target 25 mm from its stated position", [](Sequence& q, int) { target(q).place.y_mm = -25.0; }}}});
}

// --- unusable first frames

void add_first_frames(std::vector<Mode>& all) {
  const auto at_first = [](double value) { return std::vector<Knot>{{0.4, value}, {0.6, 0.0}}; };
  add(all, "bad first frame", "blurred, covered or lit by glare in frame 0 only", "kind {:.0f}", {1, 2, 3, 4, 5},
      [at_first](Sequence& q, int seed, double kind) {
        auto& sensor = q.scenario.sensor;
        if (kind == 1) sensor.defocus_px.knots = at_first(6.0);
        if (kind == 2) {
          sensor.exposure_s = 0.05;
          q.scenario.mount.rotation_x.knots = {{-0.025, 0.0}, {0.025, 0.3}};
        }
        if (kind == 3) target(q).glare.grey.knots = at_first(150.0);
        if (kind == 4) {
          cover(target(q), seed, 0.4, 0.4);
          target(q).cover.frames = {{0, 1}};
        }
        if (kind == 5) {
          cover(reference(q, seed), seed, 0.4, 0.4);
          reference(q, seed).cover.frames = {{0, 1}};
        }
      });
}

}  // namespace moiregauge::internal::faults
