// SPDX-License-Identifier: Apache-2.0
// Pinhole camera with the five-term lens model and the signs of OpenCV, in pixels.
#pragma once

#include <string>

#include "moiregauge/errors.h"

namespace moiregauge {

// Model, for a point (X, Y, Z) in camera axes (x right, y down, z forward):
//     x = X/Z, y = Y/Z, r^2 = x^2 + y^2, radial = 1 + k1 r^2 + k2 r^4 + k3 r^6
//     u = fx (x radial + 2 p1 x y + p2 (r^2 + 2 x^2)) + cx
//     v = fy (y radial + p1 (r^2 + 2 y^2) + 2 p2 x y) + cy
struct Camera {
  int width = 0;                                            // px; 0: not stated
  int height = 0;                                           // px; 0: not stated
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;            // px
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;  // dimensionless
};

// Reads a camera file: TOML with a [camera] table, or OpenCV/ROS YAML.
// Fails (kUsage): the file is missing, or has mistakes.
[[nodiscard]] MOIREGAUGE_API Expected<Camera> read_camera(const std::string& path);

}  // namespace moiregauge
