// SPDX-License-Identifier: Apache-2.0
// The sub-pixel place where four squares of a checkerboard meet: least squares of the grey levels round it.
//
// Model: two straight edges through one point, dark and light in turn; lighter side a plane of grey, darker side the
// same plane times 1 - q, between them an error function of width sigma (disc_fit.h's, with two lines for the ellipse).
// Point-symmetric, so what the print or the lens does alike on opposite sides does not move it.
#pragma once

#include <optional>

#include <Eigen/Dense>

#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct SaddleStart {
  Eigen::Vector2d at{0, 0};   // px
  Eigen::Matrix2d step;       // px; columns: along the two edges, one square each
  bool light_between = true;  // the quadrant between the two steps is light
};

struct FittedSaddle {
  Eigen::Vector2d at{0, 0};
  double u_px = 0.0;       // standard uncertainty of each coordinate, from the fit's own residual
  double contrast = 0.0;   // grey levels, light minus dark
  double explained = 0.0;  // share of the grey levels' variance
  double symmetric = 0.0;  // correlation of the grey levels with those opposite
  double weakest = 0.0;    // of the contrast: between the lighter dark quadrant and the darker light one
};

// Empty when the fit runs away or the window leaves the picture.
[[nodiscard]] std::optional<FittedSaddle> fit_saddle(const LumaView& luma, const SaddleStart& start);

}  // namespace moiregauge::internal::markers_detail
