// SPDX-License-Identifier: Apache-2.0
// Who is who: which seen circle belongs to which marker of the site.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Index into `seen` for every marker of the site that has a circle; -1 where it is not seen.
struct Identified {
  std::vector<int> circle_of_marker;                        // one per site marker
  Homography<frame::Image, frame::Board> image_from_board;  // from the identified reference circles
};

struct IdentityFailure {
  int found = 0;
  int needed = 4;
  double best_rejected_circularity = 0.0;
  std::string reason;  // "found 3 of 4 reference circles (...)", "two assignments fit equally: ..."
};

// What came nearest to being one more circle, and why it is none: "best rejected outline: W = 0.81, need > 0.84".
[[nodiscard]] std::string best_rejected_outline(const CircleSearch& search);

// First frame: all reference circles at once from the site's layout. Of the assignments that fit (reprojection of every
// reference within tolerance, diameters, no mirror image) the one nearest to upright (board x along picture x, board y up);
// look-alike circles elsewhere must not matter; two sets that fit equally well are a failure, never a guess.
[[nodiscard]] tl::expected<Identified, IdentityFailure> identify_first(const Site& site, const CircleSearch& search);

// Later frames: `previous` gives where each marker's circle was (nullopt: not seen); the assignment nearest to it that fits
// the layout as well.
struct PreviousCircles {
  Homography<frame::Image, frame::Board> image_from_board;
  double max_travel_px = 0.0;  // how far a circle may have gone; 0: anywhere, take the nearest consistent set
};
[[nodiscard]] tl::expected<Identified, IdentityFailure> identify_next(const Site& site, const CircleSearch& search,
                                                                      const PreviousCircles& previous);

}  // namespace moiregauge::internal
