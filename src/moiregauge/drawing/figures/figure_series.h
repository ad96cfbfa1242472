// SPDX-License-Identifier: Apache-2.0
// Figures 12 to 15: displacement over time as it was, and as every method measured it, the error beneath.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

// One method through one lens. NaN where it has no number.
struct MeasuredCurve {
  std::string lens;
  std::vector<double> time_s, displacement_mm, error_mm;
};
struct MethodCurves {
  std::string method;
  std::vector<MeasuredCurve> lenses;
};

struct SeriesFigure {
  std::string rotation;  // "1° about x"
  std::vector<double> time_s, true_mm, camera_deg;
  std::vector<MethodCurves> methods;
};

[[nodiscard]] Figure displacement_over_time(const SeriesFigure& contents);

}  // namespace moiregauge::internal::figure
