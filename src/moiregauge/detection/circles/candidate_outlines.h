// SPDX-License-Identifier: Apache-2.0
// Candidates for circles: outlines of an adaptively thresholded image at several scales. Their positions are good to
// about a pixel and only start the sub-pixel fit.
#pragma once

#include <vector>

#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct CandidateOutline {
  Ellipse ellipse;           // px of the full-size image, from the outline's area moments
  double circularity = 0.0;  // W of the digitised outline, perimeter by weighted chain code (error 5 to 10 %)
};

struct DiameterRange {
  double min_px = 0.0;
  double max_px = 0.0;
};

// Returns the outlines with a size in the range (+-25 %) that are neither long nor ragged, of both polarities, finest
// scale first. One circle usually appears once per scale. Returns none for an image below 8 px.
[[nodiscard]] std::vector<CandidateOutline> candidate_outlines(const LumaView& luma, DiameterRange diameters);

}  // namespace moiregauge::internal::markers_detail
