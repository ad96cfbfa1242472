// SPDX-License-Identifier: Apache-2.0
// Identification: assigns detected circles to the markers of the site.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

struct Identified {
  std::vector<int> circle_of_marker;  // per marker of the site: index into the detected circles; -1: none
  Homography<frame::Image, frame::Board> image_from_board;  // from the identified reference circles
};

struct IdentityFailure {
  int found = 0;                           // reference circles
  int needed = 4;                          // reference circles
  double best_rejected_circularity = 0.0;  // W; 0 if no outline was rejected
  std::string reason;                      // message for the user: first part of an error line
};

// Returns the most circular rejected outline and the reason: "best rejected outline: W = 0.81, need > 0.84".
[[nodiscard]] std::string best_rejected_outline(const CircleSearch& search);

// Identifies the markers in the first frame by the site's layout. Assignments must agree in positions, diameters and
// shapes and must not be mirror images. Returns the one nearest to upright (board x along image x, board y up).
// Fails: fewer than four reference circles fit, too many false candidates, or two solutions that fit equally well.
[[nodiscard]] tl::expected<Identified, IdentityFailure> identify_first(const Site& site, const CircleSearch& search);

struct PreviousCircles {
  Homography<frame::Image, frame::Board> image_from_board;
  double max_travel_px = 0.0;  // px, largest movement of a circle between the frames; 0: no limit
};
// Identifies the markers in a later frame: the assignment that fits the layout and is nearest to the previous
// positions. Fails as identify_first.
[[nodiscard]] tl::expected<Identified, IdentityFailure> identify_next(const Site& site, const CircleSearch& search,
                                                                      const PreviousCircles& previous);

}  // namespace moiregauge::internal
