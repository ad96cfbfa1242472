// SPDX-License-Identifier: Apache-2.0
// Expected uncertainty of a recording, before it is made.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/camera.h"
#include "moiregauge/site.h"
#include "moiregauge/units.h"

namespace moiregauge {

struct PlanOptions {
  Site site;                     // gratings with width, height and pitch
  Camera camera;                 // width, height, fx, fy, cx, cy
  Millimetres distance;          // from the camera to the reference plane, which it faces
  double noise_grey = 1.5;       // each pixel's noise, grey levels of 8 bits
  double contrast_grey = 170.0;  // white minus black
  double blur_px = 0.7;          // sigma of the point spread
  bool is_compressed = false;    // a typical codec of a phone or drone
};

struct PlannedTarget {
  std::string name;
  double u_dx_mm = 0.0, u_dy_mm = 0.0;          // expected u of a displacement (k = 1); NaN: not determined
  double bound_dx_mm = 0.0, bound_dy_mm = 0.0;  // Cramer-Rao bound of the fundamentals, one frame
};

// Returns the expected uncertainty of every target by method `precise`, in the order of the site.
// Model: every grating is seen frontally; the bound is that of docs/cli/plan.md. Units: mm.
// Fails (kUsage): no camera size or focal length, no distance, fewer than four references, or no target.
// Error: a view tilted by 20 degrees changes a bound by 3 %.
[[nodiscard]] MOIREGAUGE_API Expected<std::vector<PlannedTarget>> plan(const PlanOptions& options);

}  // namespace moiregauge
