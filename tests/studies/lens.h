// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::study {

// Sets a radial distortion of `percent` at the corner of the image.
inline void bend(simulator::Scenario& s, double percent) {
  const double corner = 0.5 * std::hypot(s.camera.width, s.camera.height) / s.camera.fx;
  s.camera.k1 = 0.01 * percent / (corner * corner);
}

[[nodiscard]] inline Camera lens_of(const simulator::Camera& c) {
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
}

}  // namespace moiregauge::internal::study
