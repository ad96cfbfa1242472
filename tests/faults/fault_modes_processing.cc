// SPDX-License-Identifier: Apache-2.0
// Faults by processing inside the camera: tone curves, sharpening, smoothing, earlier frames.
#include <string>

#include "faults/fault_modes.h"

namespace moiregauge::internal::faults {
namespace {

using simulator::Processing;

Processing& processing(Sequence& q) { return q.scenario.processing; }

void set_tone(Sequence& q, const std::string& name) { processing(q).tone = simulator::tone_named(name).value(); }

// The camera approaches and recedes by 5 % of its distance, like a drone. In half of the recordings the target is 30 mm
// behind the plane. Gratings change their size in the image, and edges their blur relative to it.
void approach(Sequence& q, int seed) {
  auto& mount = q.scenario.mount;
  mount.shift_z = {.amplitude = 60.0, .frequency_hz = 0.13, .phase_deg = 50.0 * seed};
  mount.shift_x = {.amplitude = 8.0, .frequency_hz = 0.19, .phase_deg = 20.0 * seed};
  target(q).print.z_mm.reset();
  target(q).place.z_mm = seed % 2 == 0 ? -30.0 : 0.0;
}

// Ten frames/s, with a target that moves by 0.02, 0.2 or 2 px.
void film(Sequence& q, int seed) {
  auto& s = q.scenario;
  s.sensor.fps = 10.0;
  s.frames = 20;
  const double amplitudes_mm[] = {0.007, 0.07, 0.7};
  target(q).dy = {.amplitude = amplitudes_mm[seed % 3], .frequency_hz = 1.0};
  target(q).dx = {.amplitude = 0.5 * amplitudes_mm[seed % 3], .frequency_hz = 0.7};
}

void add_tones(std::vector<Mode>& all) {
  add(all, "gamma", "light stored as its 1 / gamma-th power, the camera approaching", "{}", {1.0, 1.4, 1.8, 2.2, 2.6},
      [](Sequence& q, int seed, double s) {
        approach(q, seed);
        set_tone(q, fmt::format("gamma:{}", s));
      });
  add(all, "S-curve", "sRGB and an S-curve of contrast, the camera approaching", "{}", {0.2, 0.4, 0.8},
      [](Sequence& q, int seed, double s) {
        approach(q, seed);
        set_tone(q, fmt::format("s-curve:{}", s));
      });
  add(all, "local tone mapping", "in tiles of 128 px, strength", "{}", {0.2, 0.5, 1.0},
      [](Sequence& q, int seed, double s) {
        approach(q, seed);
        set_tone(q, "srgb");
        processing(q).local_tone.strength = s;
      });
  add(all, "drifting exposure, tone curve", "all light changes under sRGB, by", "{}", {0.1, 0.3, 0.6},
      [](Sequence& q, int seed, double s) {
        set_tone(q, "srgb");
        q.scenario.light.white = 150.0;
        q.scenario.light.black = 15.0;
        q.scenario.light.flicker = {.amplitude = s, .frequency_hz = 0.07, .phase_deg = 40.0 * seed};
      });
  add(all, "clipped white", "sRGB, the paper full from the first frame on: white at", "{} grey levels", {260, 320, 450},
      [](Sequence& q, int seed, double s) {
        approach(q, seed);
        set_tone(q, "srgb");
        q.scenario.light.white = s;
      });
  add(all, "vignetting", "the corners darker under sRGB, by", "{}", {0.2, 0.5, 0.8},
      [](Sequence& q, int seed, double s) {
        approach(q, seed);
        set_tone(q, "srgb");
        q.scenario.light.vignetting = s;
      });
}

void add_sharpness(std::vector<Mode>& all) {
  add(all, "sharpening", "sRGB and an unsharp mask of 0.7 to 1.6 px, amount", "{}", {0.3, 0.8, 2.0},
      [](Sequence& q, int seed, double s) {
        approach(q, seed);
        set_tone(q, "srgb");
        processing(q).sharpen_amount = s;
        processing(q).sharpen_radius_px = 0.7 + 0.3 * (seed % 4);
      });
  add(all, "ringing", "a scaler's low-pass, cycles per px", "{}", {0.35, 0.25, 0.15},
      [](Sequence& q, int seed, double s) {
        approach(q, seed);
        processing(q).low_pass = s;
      });
  add(all, "defocus by distance", "a lens focused on the first distance, the camera approaching: its aperture", "{} mm",
      {5, 15, 40}, [](Sequence& q, int seed, double s) {
        approach(q, seed);
        q.scenario.optics.focus_mm = q.scenario.mount.distance_mm;
        q.scenario.optics.aperture_mm = s;
      });
  add(all, "smoothing", "bilateral filter of 1.5 px, over grey levels of", "{}", {8, 20, 50},
      [](Sequence& q, int seed, double s) {
        film(q, seed);
        processing(q).bilateral_px = 1.5;
        processing(q).bilateral_grey = s;
      });
  add(all, "median", "the middle grey level of a window", "{:.0f} px", {3, 5, 7}, [](Sequence& q, int seed, double s) {
    film(q, seed);
    processing(q).median_px = static_cast<int>(s);
  });
  add(all, "larger pixels", "blocks show their mean: doubled, or enlarged by nearest neighbours", "{} px",
      {1.333, 1.5, 2, 3}, [](Sequence& q, int seed, double s) {
        film(q, seed);
        processing(q).pixel_size = s;
      });
}

void add_memory(std::vector<Mode>& all) {
  add(all, "recursion", "temporal noise reduction, share of the frames before", "{}", {0.1, 0.3, 0.6, 0.85},
      [](Sequence& q, int seed, double s) {
        film(q, seed);
        processing(q).recursion = s;
      });
  add(all, "recursion, adaptive", "the same where little has changed: grey levels", "{}", {4, 12, 40},
      [](Sequence& q, int seed, double s) {
        film(q, seed);
        processing(q).recursion = 0.7;
        processing(q).motion_grey = s;
      });
  add(all, "frames averaged", "every frame the mean of N", "{:.0f}", {2, 3, 6}, [](Sequence& q, int seed, double s) {
    film(q, seed);
    processing(q).average_frames = static_cast<int>(s);
  });
  add(all, "frames repeated", "a camera of fewer frames a second: each shown so often", "{:.0f}", {2, 3},
      [](Sequence& q, int seed, double s) {
        film(q, seed);
        const long often = static_cast<long>(s);
        for (long frame = 0; frame < q.scenario.frames; frame += often)
          q.scenario.timing.repeated.push_back({frame + 1, frame + often});
        q.scenario.timing.nominal_stamps = true;
      });
}

}  // namespace

void add_processing(std::vector<Mode>& all) {
  add_tones(all);
  add_sharpness(all);
  add_memory(all);
}

}  // namespace moiregauge::internal::faults
