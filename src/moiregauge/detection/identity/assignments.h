// SPDX-License-Identifier: Apache-2.0
// Which seen circles can be which reference circles: every assignment the layout allows, with the evidence for it.
//
// A homography carries any four points to any other four, so positions alone prove nothing. The circles themselves do:
// the ellipse of a circle of known size gives the local scale and tilt, which must agree with the map that the centres
// give.
#pragma once

#include <functional>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal::markers_detail {

struct ReferenceCircle {
  BoardPoint centre;
  double diameter_mm = 0.0;  // 0: not stated
};

struct Assignment {
  std::vector<int> circle_of_reference;  // index into the seen circles, -1: not seen
  Homography<frame::Image, frame::Board> image_from_board;
  double misfit = 0.0;    // sum of squared deviations over their expected spread: sizes, shapes, positions, absences
  double roll_rad = 0.0;  // of the board in the picture, 0 when x points right and y up
};

struct AssignmentSearch {
  std::vector<Assignment> assignments;
  bool gave_up = false;  // too many look-alikes to try them all
};

// may_be(reference, circle) says what is to be tried at all.
[[nodiscard]] AssignmentSearch find_assignments(const std::vector<ReferenceCircle>& references,
                                                const std::vector<DetectedCircle>& seen, double position_mm,
                                                const std::function<bool(std::size_t, std::size_t)>& may_be);

}  // namespace moiregauge::internal::markers_detail
