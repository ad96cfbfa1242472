// SPDX-License-Identifier: Apache-2.0
// Everything a simulated recording is made of. Values only; the built-in ones are in built_in.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "moiregauge/simulator/track.h"
#include "moiregauge/site/site.h"

namespace moiregauge::simulator {

// Pinhole and OpenCV's lens model, in pixels; camera x right, y down, z forward.
struct Camera {
  int width = 1024;  // px
  int height = 512;
  double fx = 3478.26, fy = 3478.26, cx = 511.5, cy = 255.5;
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
};

// Board point (x, y, z) at rest in the camera: B (x, -y, -z) + (0, 0, distance), B = Rx Ry Rz of the board's own
// angles. The camera's movement takes that to X_cam = Rx Ry Rz (X - pivot) + pivot + shift, right-handed about camera
// axes.
struct Mount {
  double distance_mm = 1200.0;
  double board_x_deg = 0.0, board_y_deg = 0.0, board_z_deg = 0.0;
  double pivot_x_mm = 0.0, pivot_y_mm = 0.0, pivot_z_mm = -100.0;  // 100 mm behind the lens
  // Degrees, then mm; random ones differ from axis to axis.
  Track rotation_x{.random_seed = 1}, rotation_y{.random_seed = 2}, rotation_z{.random_seed = 3};
  Track shift_x{.random_seed = 4}, shift_y{.random_seed = 5}, shift_z{.random_seed = 6};
};

// Grey levels are those of an 8-bit picture; 10 and 12 bits multiply them by 4 and 16.
struct Light {
  double white = 210.0;
  double black = 40.0;
  double background = 110.0;
  double texture = 0.0;     // rms of a rough background, grey levels
  double vignetting = 0.0;  // relative loss at the corner of the picture, growing with r^2
  double slope_x = 0.0;     // relative change of light from the centre to the right edge
  double slope_y = 0.0;     // and to the lower edge
};

// EMVA 1288 in grey levels: variance = sigma^2 + gain * level. Quantisation comes on top.
struct Sensor {
  double psf_sigma_px = 0.7;
  double noise_sigma = 1.5;
  double noise_gain = 0.0;
  int bits = 8;
  double fps = 10.0;
  double exposure_s = 1.0 / 80.0;  // centred on frame / fps
  double readout_s = 0.0;          // rolling shutter: from the first row's exposure to the last one's; 0: all at once
};

// Frames from..to, the last left out.
struct FrameSpan {
  long from = 0;
  long to = 0;
};

// Something opaque and even, held before a marker's sheet.
struct Cover {
  std::vector<FrameSpan> frames;
  double share = 1.0;  // of the sheet's width, from its left edge
  double grey = 90.0;
};

// What stands there. `print` is what site.toml says of it; `place` is by how much the truth differs from that.
struct SceneMarker {
  Marker print;
  bool inverted = false;          // white lines on black
  double paper_margin_mm = 10.0;  // white paper around circle and grating
  bool listed = true;             // false: a look-alike that site.toml does not know
  struct Place {
    double x_mm = 0.0, y_mm = 0.0, z_mm = 0.0;
    double rotation_deg = 0.0;  // counter-clockwise about the marker's own centre
    double print_scale = 0.0;   // relative: 0.001 is a print a thousandth too large, about that centre
  } place;
  Cover cover;
  Track dx, dy, dz;  // mm
};

// Which of the site's errors are drawn: each from a normal distribution as wide as [known_to] says.
struct Draw {
  bool position = false, rotation = false, height = false, print_scale = false;
  std::uint64_t seed = 0;  // 0: one that follows from the scenario's
};

struct Scenario {
  std::string name;
  Camera camera;
  Mount mount;
  Light light;
  Sensor sensor;
  std::vector<SceneMarker> markers;
  KnownTo known_to;  // as site.toml states it
  Draw draw;
  int decoys = 0;  // look-alike circles strewn over the background
  long frames = 161;
  std::uint64_t seed = 1;
};

[[nodiscard]] inline double time_of(const Scenario& scenario, long frame) {
  return static_cast<double>(frame) / scenario.sensor.fps;
}

// By how much row y of the picture is exposed later than the picture's middle.
[[nodiscard]] inline double delay_of_row(const Scenario& scenario, int y) {
  return ((y + 0.5) / scenario.camera.height - 0.5) * scenario.sensor.readout_s;
}

// By how much a marker truly stands elsewhere than site.toml says: its `place`, and what was drawn.
[[nodiscard]] SceneMarker::Place true_place(const Scenario& scenario, const SceneMarker& marker);

}  // namespace moiregauge::simulator
