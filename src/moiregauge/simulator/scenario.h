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
  Track rotation_x, rotation_y, rotation_z;                        // degrees
  Track shift_x, shift_y, shift_z;                                 // mm
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
  } place;
  Track dx, dy, dz;  // mm
};

struct Scenario {
  std::string name;
  Camera camera;
  Mount mount;
  Light light;
  Sensor sensor;
  std::vector<SceneMarker> markers;
  int decoys = 0;  // look-alike circles strewn over the background
  long frames = 161;
  std::uint64_t seed = 1;
};

[[nodiscard]] inline double time_of(const Scenario& scenario, long frame) {
  return static_cast<double>(frame) / scenario.sensor.fps;
}

}  // namespace moiregauge::simulator
