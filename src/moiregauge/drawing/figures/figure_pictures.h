// SPDX-License-Identifier: Apache-2.0
// Draws figures 4 and 8 to 11 of the paper: an image, its detections, and the stabilised image.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "moiregauge/drawing/surface/picture_box.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal::figure {

// Figure 4: an image with accepted and rejected outlines, and the circle centres.
struct CirclesFigure {
  GreyView picture;
  CircleSearch search;
};
[[nodiscard]] Figure circles_found(const CirclesFigure& contents);

// Figures 8 and 10: an image before and after stabilisation.
struct StabilisedFigure {
  std::string turn;        // rotation of the camera from `before` to `after`: "1° about x, y and z"
  GreyView before, after;  // reference frame and a later one
  const Reference* reference = nullptr;
  const Observation* now = nullptr;     // observation of `after` by the two-stage method
  std::array<double, 2> residual_px{};  // largest residual displacement of the reference gratings after each stage
};
[[nodiscard]] Figure before_and_after(const StabilisedFigure& contents);

// Figures 9 and 11: the target over time.
struct Shot {
  double time_s = 0.0;
  Image<std::uint8_t> captured, held;  // crops around the same pixel
};
struct CropsFigure {
  double reference_time_s = 0.0;
  Image<std::uint8_t> reference;
  std::vector<Shot> shots;
};
[[nodiscard]] Figure crops_over_time(const CropsFigure& contents);

}  // namespace moiregauge::internal::figure
