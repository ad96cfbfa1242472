// SPDX-License-Identifier: Apache-2.0
// Where circles might be: outlines of a locally thresholded picture at several scales. Nothing here is sub-pixel; each
// candidate only says where to look closer.
#pragma once

#include <vector>

#include "moiregauge/detection/circles/ellipse.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

struct CandidateOutline {
  Ellipse ellipse;           // from the outline's area moments, picture coordinates
  double circularity = 0.0;  // W of the digitised outline, perimeter by weighted chain code: good to a few per cent
};

struct DiameterRange {
  double min_px = 0.0;
  double max_px = 0.0;
};

// Outlines whose size lies in the range and that are not hopelessly long or ragged, both polarities, finest scale
// first. The same circle is usually there once per scale.
[[nodiscard]] std::vector<CandidateOutline> candidate_outlines(const LumaView& luma, DiameterRange diameters);

}  // namespace moiregauge::internal::markers_detail
