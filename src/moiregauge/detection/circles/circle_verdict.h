// SPDX-License-Identifier: Apache-2.0
// Tests whether a candidate is a circle: circularity W (paper Eq. 6), distance from an ellipse, and a fit of the disc.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct CircleVerdict {
  std::optional<DetectedCircle> circle;
  double circularity = 0.0;  // W of the sub-pixel outline, also if the candidate was rejected
  std::string why;           // reason for rejection; empty for a circle
};

// Traces the outline at `start` and fits a disc to it. `ellipse_slack` multiplies the limit of the rms distance from an
// ellipse. A rejected candidate has no `circle` and a reason in `why`.
[[nodiscard]] CircleVerdict judge_circle(const LumaView& luma, const Ellipse& start, const CircleOptions& options,
                                         double ellipse_slack = 1.0);

}  // namespace moiregauge::internal::markers_detail
