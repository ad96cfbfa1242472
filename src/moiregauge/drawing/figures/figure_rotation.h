// SPDX-License-Identifier: Apache-2.0
// Draws the error of every method against the rotation of the camera, on logarithmic axes, with one panel per lens.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

enum class Turn { kOneAxis, kAllAxes };  // about x; about x, y and z at once

// Errors of one method in one run. NaN: no value.
struct RotationPoint {
  Turn turn = Turn::kOneAxis;
  double rotation_deg = 0.0;  // about each of the axes
  double largest_mm = 0.0, rms_mm = 0.0;
  bool some_lost = false;  // frames without values, which the errors exclude
};
struct RotationCurve {
  std::string method;
  std::vector<RotationPoint> points;
};
struct RotationPanel {
  std::string lens;
  std::vector<RotationCurve> methods;
};
// The published error of a case.
struct PublishedError {
  Turn turn = Turn::kOneAxis;
  double rotation_deg = 0.0, error_mm = 0.0;
};

struct RotationFigure {
  std::vector<RotationPanel> lenses;  // with the same methods in each
  std::vector<PublishedError> published;
};

[[nodiscard]] Figure error_against_rotation(const RotationFigure& contents);

}  // namespace moiregauge::internal::figure
