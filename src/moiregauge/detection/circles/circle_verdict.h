// SPDX-License-Identifier: Apache-2.0
// Is there a circle where an ellipse was seen? W of seed paper Eq. (6), an ellipse test beside it, a fit of the disc.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct CircleVerdict {
  std::optional<DetectedCircle> circle;
  double circularity = 0.0;  // W of the sub-pixel outline, also of what is no circle
  std::string why;           // it is none
};

// `ellipse_slack`: by so much more than usual may the outline differ from an ellipse.
[[nodiscard]] CircleVerdict judge_circle(const LumaView& luma, const Ellipse& start, const CircleOptions& options,
                                         double ellipse_slack = 1.0);

}  // namespace moiregauge::internal::markers_detail
