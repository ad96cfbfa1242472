// SPDX-License-Identifier: Apache-2.0
// Draws figures 12 to 15: true displacement over time, that measured by every method, and the error.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

// Values of one method with one lens. NaN: no value.
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
