// SPDX-License-Identifier: Apache-2.0
// The error of every method against how far the camera turned, on logarithmic axes: a panel per lens.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

enum class Turn { kOneAxis, kAllAxes };  // about x; about x, y and z at once

// One method over one run. NaN where it has no number.
struct RotationPoint {
  Turn turn = Turn::kOneAxis;
  double rotation_deg = 0.0;  // about each of the axes
  double largest_mm = 0.0, rms_mm = 0.0;
  bool some_lost = false;  // frames without a number: the errors are those of the others
};
struct RotationCurve {
  std::string method;
  std::vector<RotationPoint> points;
};
struct RotationPanel {
  std::string lens;
  std::vector<RotationCurve> methods;
};
// What was published for a case: one number.
struct PublishedError {
  Turn turn = Turn::kOneAxis;
  double rotation_deg = 0.0, error_mm = 0.0;
};

struct RotationFigure {
  std::vector<RotationPanel> lenses;  // the same methods in each
  std::vector<PublishedError> published;
};

[[nodiscard]] Figure error_against_rotation(const RotationFigure& contents);

}  // namespace moiregauge::internal::figure
