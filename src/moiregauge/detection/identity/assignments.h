// SPDX-License-Identifier: Apache-2.0
// Assignments of detected circles to reference circles that the layout allows, each with its residual.
//
// A homography maps any four points to any other four, so four positions are no evidence. The ellipses are: a circle of
// known size gives the local scale and tilt, which must agree with the homography of the centres.
#pragma once

#include <functional>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal::markers_detail {

struct ReferenceCircle {
  BoardPoint centre;         // mm
  double diameter_mm = 0.0;  // mm; 0: not stated
};

struct Assignment {
  std::vector<int> circle_of_reference;  // index into the detected circles, -1: not detected
  Homography<frame::Image, frame::Board> image_from_board;
  double misfit = 0.0;    // sum of squares of residuals / spread: sizes, shapes, positions; 25 per missing reference
  double roll_rad = 0.0;  // rad, rotation of the board in the image, 0 if x points right and y up
};

struct AssignmentSearch {
  std::vector<Assignment> assignments;
  bool gave_up = false;  // the limit of partial assignments was reached: too many false candidates
};

// Finds all assignments of at least four references that the ellipses allow. may_be(reference, circle) returns false
// for pairs to exclude. `position_mm` is the standard uncertainty of the stated positions. Fails (gave_up = true) after
// 3 million partial assignments.
[[nodiscard]] AssignmentSearch find_assignments(const std::vector<ReferenceCircle>& references,
                                                const std::vector<DetectedCircle>& seen, double position_mm,
                                                const std::function<bool(std::size_t, std::size_t)>& may_be);

}  // namespace moiregauge::internal::markers_detail
