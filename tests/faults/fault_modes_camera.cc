// SPDX-License-Identifier: Apache-2.0
// Faults of the camera: lens, shutter, light, sensor, clock, codec.
#include <cmath>

#include "faults/fault_modes.h"

namespace moiregauge::internal::faults {

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
  add(all, "haze", "each marker's image moves independently, rms", "{} mm", {0.003, 0.01, 0.03, 0.1},
      [](Sequence& q, int, double s) { q.scenario.haze = {.rms_mm = s, .step_s = 1.0}; });
}

namespace {

// Shifts by `length` during the exposure of frames 4 and 7.
std::vector<Knot> jerks(double length, double exposure_s) {
  std::vector<Knot> knots{{-1.0, 0.0}};
  for (const double at : {4.0, 7.0}) {
    const double before = knots.back().value;
    knots.push_back({at - 0.5 * exposure_s, before});
    knots.push_back({at + 0.5 * exposure_s, before == 0.0 ? length : 0.0});
  }
  return knots;
}

}  // namespace

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

namespace {

// --- compressed: ten frames/s, motions of 0.02, 0.2 and 2 px

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

}  // namespace

void add_codecs(std::vector<Mode>& all) {
  add(all, "H.264", "x264 as a telephone writes it, rate factor", "crf {:.0f}", {12, 18, 23, 28, 35},
      [](Sequence& q, int seed, double s) { compress(q, seed, VideoCodec::kX264, static_cast<int>(s), 250); });
  add(all, "H.264, key frames only", "each frame coded separately, rate factor", "crf {:.0f}", {12, 18, 23, 28},
      [](Sequence& q, int seed, double s) { compress(q, seed, VideoCodec::kX264, static_cast<int>(s), 1); });
  add(all, "MJPEG", "every frame a JPEG, quantiser", "q {:.0f}", {2, 5, 10, 20},
      [](Sequence& q, int seed, double s) { compress(q, seed, VideoCodec::kMjpeg, static_cast<int>(s), 1); });
}

}  // namespace moiregauge::internal::faults
