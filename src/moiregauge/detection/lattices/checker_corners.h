// SPDX-License-Identifier: Apache-2.0
// Candidates for corners of checkerboards: points where two dark and two light sectors meet.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct CheckerCorner {
  Eigen::Vector2d at{0, 0};  // px
  double light_rad = 0.0;  // TWICE the direction in which it is light, from image x towards image y; wraps like a phase
  double contrast = 0.0;   // grey levels, light minus dark
};

// Detects corner candidates at four scales, finer scales first, each position once. `bits` is the bit depth of the
// image. Error: about 0.25 px at the scale of detection.
[[nodiscard]] std::vector<CheckerCorner> find_checker_corners(const LumaView& luma, int bits);

}  // namespace moiregauge::internal::markers_detail
