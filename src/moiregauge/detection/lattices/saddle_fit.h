// SPDX-License-Identifier: Apache-2.0
// Sub-pixel position of a corner of a checkerboard: least squares fit to the grey levels around it.
//
// Model: two straight edges through one point, with dark and light quadrants in turn. The light quadrants are a
// plane of grey levels, the dark ones the same plane times 1 - q. The edges are error functions of width sigma, as in
// disc_fit.h. The model is point-symmetric, so symmetric errors of printing or lens do not move the corner.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct SaddleStart {
  Eigen::Vector2d at{0, 0};   // px
  Eigen::Matrix2d step;       // px; columns: steps of one square along the two edges
  bool light_between = true;  // true if the quadrant between the two steps is light
};

struct FittedSaddle {
  Eigen::Vector2d at{0, 0};  // px
  double u_px = 0.0;         // px, standard uncertainty (k = 1) of each coordinate, from the residual of the fit
  double contrast = 0.0;     // grey levels, light minus dark
  double explained = 0.0;    // share of the variance of the grey levels
  double symmetric = 0.0;    // correlation between opposite pixels, 1 for an ideal corner
  double weakest = 0.0;      // share of the contrast, from the lighter dark quadrant to the darker light one
};

// Fits the corner model in a window of 0.4 squares radius (2.5 to 12 px). Empty if the fit diverges, moves by more than
// half a square, or the window is not inside the image.
[[nodiscard]] std::optional<FittedSaddle> fit_saddle(const LumaView& luma, const SaddleStart& start);

}  // namespace moiregauge::internal::markers_detail
