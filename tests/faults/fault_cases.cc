// SPDX-License-Identifier: Apache-2.0
// RELIABILITY's list of what goes wrong, as scenarios. A pitch is 10 mm and 29 px, a grating 30 or 40 mm wide.
#include "faults/fault_cases.h"

#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::faults {
namespace {

using simulator::Knot;
using simulator::SceneMarker;
using simulator::Track;

constexpr double kPxPerMm = 3478.26 / 1200.0;

SceneMarker& marker(Sequence& q, const char* name) {
  for (SceneMarker& m : q.scenario.markers) {
    if (m.print.name == name) return m;
  }
  return q.scenario.markers.front();
}
SceneMarker& target(Sequence& q) { return marker(q, "mid"); }
SceneMarker& reference(Sequence& q, int seed) { return q.scenario.markers[static_cast<std::size_t>(seed) % 4]; }

// Mostly a fault begins behind frame 3; in every fourth recording it is there from the first frame on.
double onset_s(int seed) { return seed % 4 == 3 ? -1.0 : 3.5; }
std::vector<simulator::FrameSpan> from_onset(int seed) { return {{seed % 4 == 3 ? 0 : 4, 100}}; }
std::vector<Knot> step(int seed, double value, double rest = 0.0) {
  return {{onset_s(seed), rest}, {onset_s(seed) + 0.1, value}};
}

using Change = std::function<void(Sequence&, int seed, double strength)>;

std::vector<Mode::Strength> strengths(const char* words, std::initializer_list<double> values, const Change& change) {
  std::vector<Mode::Strength> list;
  for (const double value : values) {
    list.push_back(
        {fmt::format(fmt::runtime(words), value), [change, value](Sequence& q, int seed) { change(q, seed, value); }});
  }
  return list;
}

void add(std::vector<Mode>& all, const char* name, const char* what, const char* words,
         std::initializer_list<double> values, const Change& change) {
  all.push_back({name, what, false, strengths(words, values, change)});
}

// --- before the sheets

void cover(SceneMarker& m, int seed, double share, double height_share) {
  m.cover.frames = from_onset(seed);
  m.cover.share = share;
  m.cover.height_share = height_share;
  m.cover.grey = seed % 3 == 0 ? 30.0 : 120.0;
  m.cover.texture = seed % 2 == 0 ? 0.0 : 15.0;
}

// A strip as wide as `share` of the sheet walks across it.
void sweep(SceneMarker& m, int seed, double share, double grey, double opacity) {
  cover(m, seed, share, 1.0);
  m.cover.grey = grey;
  m.cover.opacity = opacity;
  m.cover.x_mm.knots = {{3.0, -30.0}, {9.0, 60.0}};
}

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

// --- optics

void add_optics(std::vector<Mode>& all) {
  add(all, "defocus, Gaussian", "a further sigma from frame 4 on", "{} px", {1, 3, 6, 10},
      [](Sequence& q, int seed, double s) { q.scenario.sensor.defocus_px.knots = step(seed, s); });
  add(all, "defocus, disc", "a lens out of focus: radius of the disc", "{} px", {4, 9, 18},
      [](Sequence& q, int seed, double s) {
        q.scenario.sensor.defocus_disc_px.knots = step(seed, s);
        q.scenario.frames = 7;
      });
  add(all, "zoom", "the focal length steps", "{} of it", {0.0005, 0.005, 0.05},
      [](Sequence& q, int seed, double s) { q.scenario.optics.zoom.knots = step(seed, s); });
  add(all, "focus breathing", "focal length and sharpness swing together", "{} of it", {0.001, 0.003, 0.01},
      [](Sequence& q, int seed, double s) {
        q.scenario.optics.zoom = {.amplitude = s, .frequency_hz = 0.17, .phase_deg = 40.0 * seed};
        q.scenario.sensor.defocus_px = {.amplitude = 600.0 * s, .frequency_hz = 0.17, .phase_deg = 40.0 * seed};
      });
  add(all, "stabiliser", "the lens travels across its image", "{} px", {0.5, 3, 15},
      [](Sequence& q, int seed, double s) {
        q.scenario.optics.shift_x = {.amplitude = s, .frequency_hz = 0.23, .phase_deg = 70.0 * seed};
        q.scenario.optics.shift_y = {.amplitude = s, .frequency_hz = 0.31, .phase_deg = 20.0 * seed};
      });
  add(all, "haze", "every marker's picture wanders by itself, rms", "{} mm", {0.003, 0.01, 0.03, 0.1},
      [](Sequence& q, int, double s) { q.scenario.haze = {.rms_mm = s, .step_s = 1.0}; });
}

// Shifts by `length` during the exposure of every third frame.
std::vector<Knot> jerks(double length, double exposure_s) {
  std::vector<Knot> knots{{-1.0, 0.0}};
  for (const double at : {4.0, 7.0}) {
    const double before = knots.back().value;
    knots.push_back({at - 0.5 * exposure_s, before});
    knots.push_back({at + 0.5 * exposure_s, before == 0.0 ? length : 0.0});
  }
  return knots;
}

void add_blur(std::vector<Mode>& all) {
  constexpr double kExposure_s = 0.05;
  add(all, "motion blur, target", "the target moves during the exposure", "{} pitch", {0.1, 0.3, 0.6, 0.9, 1.0, 1.3},
      [](Sequence& q, int seed, double s) {
        q.scenario.sensor.exposure_s = kExposure_s;
        (seed % 2 == 0 ? target(q).dy : target(q).dx).knots = jerks(10.0 * s, kExposure_s);
      });
  add(all, "motion blur, camera", "the camera turns during the exposure", "{} pitch", {0.1, 0.3, 0.6, 0.9, 1.3},
      [](Sequence& q, int seed, double s) {
        q.scenario.sensor.exposure_s = kExposure_s;
        const double degrees = s * 10.0 / 1300.0 * 57.29578;
        auto& mount = q.scenario.mount;
        (seed % 2 == 0 ? mount.rotation_x : mount.rotation_y).knots = jerks(degrees, kExposure_s);
      });
  add(all, "rolling shutter", "30 frames/s, camera swaying 0.2 deg at 3 Hz: read-out", "{} s", {0.005, 0.015, 0.03},
      [](Sequence& q, int seed, double s) {
        q.scenario.sensor.fps = 30.0;
        q.scenario.sensor.readout_s = s;
        double phase_deg = 37.0 * seed;
        for (Track* track : {&q.scenario.mount.rotation_x, &q.scenario.mount.rotation_y, &q.scenario.mount.rotation_z})
          *track = {.amplitude = 0.2, .frequency_hz = 3.0, .phase_deg = phase_deg += 100.0};
        target(q).dy = {.amplitude = 0.5, .frequency_hz = 2.0};
      });
  add(all, "interlaced", "odd rows half a frame later, the target moving", "{} mm/s", {0.0, 2.0, 10.0},
      [](Sequence& q, int seed, double s) {
        q.scenario.sensor.interlaced = true;
        q.scenario.sensor.fps = 25.0;
        q.scenario.mount.rotation_x = q.scenario.mount.rotation_y = q.scenario.mount.rotation_z = {};
        (seed % 2 == 0 ? target(q).dy : target(q).dx).knots = {{0.0, 0.0}, {10.0, 10.0 * s}};
      });
}

// --- light and sensor

void add_light(std::vector<Mode>& all) {
  add(all, "flicker", "all light up and down", "{} of it", {0.05, 0.2, 0.5}, [](Sequence& q, int seed, double s) {
    q.scenario.light.flicker = {.amplitude = s, .frequency_hz = 0.37, .phase_deg = 50.0 * seed};
  });
  add(all, "dimmed", "the light goes from frame 4 on", "{} of it left", {0.5, 0.2, 0.05},
      [](Sequence& q, int seed, double s) { q.scenario.light.flicker.knots = step(seed, s - 1.0); });
  add(all, "one-sided light", "falls off to one side of the picture from frame 4 on", "{} at the edge", {0.2, 0.5, 0.8},
      [](Sequence& q, int seed, double s) {
        (seed % 2 == 0 ? q.scenario.light.slope_x : q.scenario.light.slope_y).knots = step(seed, s);
      });
  add(all, "saturated", "more light from frame 4 on: white at", "{} grey levels", {250, 280, 350, 600},
      [](Sequence& q, int seed, double s) { q.scenario.light.flicker.knots = step(seed, s / 210.0 - 1.0); });
  add(all, "tone curve", "gamma", "{}", {0.5, 1.8, 2.4},
      [](Sequence& q, int, double s) { q.scenario.sensor.gamma = s; });
  add(all, "noise", "sigma", "{} grey levels", {4, 10, 25},
      [](Sequence& q, int, double s) { q.scenario.sensor.noise_sigma = s; });
  add(all, "row noise", "shared by a row, rms", "{} grey levels", {1, 4, 10},
      [](Sequence& q, int, double s) { q.scenario.sensor.row_noise = s; });
}

// --- prints and places

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
  all.back().vouched_for = true;
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
  add(all, "target comes nearer", "by so much over the recording", "{} mm", {1, 5, 20}, [](Sequence& q, int, double s) {
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
  // Layouts change with every seed: even ones have four references.
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

// --- who is who

void add_identity(std::vector<Mode>& all) {
  add(all, "look-alikes", "circles strewn over the background", "{:.0f} of them", {10, 40, 100},
      [](Sequence& q, int, double s) { q.scenario.decoys = static_cast<int>(s); });
  add(all, "second target", "an unlisted copy of the target beside it", "{} mm away", {-62, 62},
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
       "site.toml is wrong about who hangs where",
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
        {"a reference 10 mm (a pitch) beside its place",
         [](Sequence& q, int seed) { reference(q, seed).place.x_mm = 10.0; }},
        {"a reference 5 mm beside its place", [](Sequence& q, int seed) { reference(q, seed).place.y_mm = 5.0; }},
        {"a reference 30 mm beside its place",
         [](Sequence& q, int seed) { reference(q, seed).place.x_mm = seed % 2 == 0 ? 30.0 : -30.0; }},
        {"the target 10 mm beside its place", [](Sequence& q, int) { target(q).place.x_mm = 10.0; }},
        {"the target 25 mm beside its place", [](Sequence& q, int) { target(q).place.y_mm = -25.0; }}}});
}

// --- first frames that are no good

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

// --- time

void add_timing(std::vector<Mode>& all) {
  add(all, "jitter", "exposures early or late, time stamps nominal", "{} of a frame", {0.1, 0.4},
      [](Sequence& q, int, double s) {
        q.scenario.timing.jitter_s = s;
        q.scenario.timing.nominal_stamps = true;
      });
  add(all, "dropped and repeated", "shots missing, frames shown again", "{:.0f} of them", {1, 3},
      [](Sequence& q, int, double s) {
        const long count = static_cast<long>(s);
        q.scenario.timing.dropped = {{3, 3 + count}};
        q.scenario.timing.repeated = {{6, 6 + count}};
      });
}

// --- compressed: ten frames a second, motions of 0.02, 0.2 and 2 px

void compress(Sequence& q, int seed, VideoCodec codec, int quality, int gop) {
  auto& s = q.scenario;
  s.sensor.fps = 10.0;
  s.frames = 24;
  s.timing.jitter_s = seed % 3 == 0 ? 0.01 : 0.0;
  const double amplitudes_mm[] = {0.007, 0.07, 0.7};
  target(q).dy = {.amplitude = amplitudes_mm[seed % 3], .frequency_hz = 1.0};
  target(q).dx = {.amplitude = 0.5 * amplitudes_mm[seed % 3], .frequency_hz = 0.7};
  for (Track* track : {&s.mount.rotation_x, &s.mount.rotation_y, &s.mount.rotation_z}) track->random = 0.0;
  VideoFormat format{codec, quality};
  format.gop = gop;
  format.width = s.camera.width;
  format.height = s.camera.height;
  format.fps = s.sensor.fps;
  q.video = format;
}

void add_codecs(std::vector<Mode>& all) {
  add(all, "H.264", "x264 as a telephone writes it, rate factor", "crf {:.0f}", {12, 18, 23, 28, 35},
      [](Sequence& q, int seed, double s) { compress(q, seed, VideoCodec::kX264, static_cast<int>(s), 250); });
  add(all, "H.264, key frames only", "every frame by itself, rate factor", "crf {:.0f}", {12, 18, 23, 28},
      [](Sequence& q, int seed, double s) { compress(q, seed, VideoCodec::kX264, static_cast<int>(s), 1); });
  add(all, "MJPEG", "every frame a JPEG, quantiser", "q {:.0f}", {2, 5, 10, 20},
      [](Sequence& q, int seed, double s) { compress(q, seed, VideoCodec::kMjpeg, static_cast<int>(s), 1); });
}

// --- nothing wrong

void add_clean(std::vector<Mode>& all) {
  std::vector<Mode::Strength> prints;
  for (const Pattern pattern :
       {Pattern::kGrid, Pattern::kSquares, Pattern::kDots, Pattern::kCheckerboard, Pattern::kCosine}) {
    prints.push_back({word_for(pattern), [pattern](Sequence& q, int) {
                        for (SceneMarker& m : q.scenario.markers) m.print.grating->pattern = pattern;
                      }});
  }
  all.push_back({"clean", "nothing is wrong: prints of five kinds", true, prints});
  std::vector<Mode::Strength> sensors;
  sensors.push_back({"12 bits", [](Sequence& q, int) { q.scenario.sensor.bits = 12; }});
  sensors.push_back({"shot noise", [](Sequence& q, int) { q.scenario.sensor.noise_gain = 0.03; }});
  sensors.push_back({"little noise", [](Sequence& q, int) { q.scenario.sensor.noise_sigma = 0.6; }});
  sensors.push_back({"vignetting", [](Sequence& q, int) {
                       q.scenario.light.vignetting = 0.3;
                       q.scenario.light.slope_x.offset = 0.1;
                     }});
  sensors.push_back({"soft lens", [](Sequence& q, int) { q.scenario.sensor.psf_sigma_px = 1.4; }});
  all.push_back({"clean, other cameras", "nothing is wrong: depth, noise, light and sharpness vary", true, sensors});
  all.push_back({"lossless video", "nothing is wrong: FFV1 through a file", true, {{"ffv1", [](Sequence& q, int) {
                                                                                      VideoFormat format;
                                                                                      format.width =
                                                                                          q.scenario.camera.width;
                                                                                      format.height =
                                                                                          q.scenario.camera.height;
                                                                                      q.video = format;
                                                                                    }}}});
}

}  // namespace

const std::vector<Mode>& modes() {
  static const std::vector<Mode> all = [] {
    std::vector<Mode> list;
    for (const auto add_some : {add_clean, add_covers, add_glare, add_optics, add_blur, add_light, add_prints,
                                add_moves, add_identity, add_first_frames, add_timing, add_codecs})
      add_some(list);
    return list;
  }();
  return all;
}

}  // namespace moiregauge::faults
