// SPDX-License-Identifier: Apache-2.0
// Which point of one view is which of another, when a board may have been turned by quarters and its rims cut off. What
// tells is the print itself: a place that was printed to the right of where it should be is so in every view.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal {

// One point of a view: its column and row as the view counts them (y up), and how far it was seen from its place, in
// any unit of the board's.
struct PlacedPoint {
  int x = 0;
  int y = 0;
  Eigen::Vector2d off{0, 0};
};

// A view's points in a count common to all. No cells: the view could not be recognised. Views in which the print says
// nothing stay apart.
struct MatchedView {
  int turns = 0;  // quarters, counter-clockwise, from the view's count to the common one
  std::vector<std::pair<int, int>> cells;
};
[[nodiscard]] std::vector<MatchedView> match_places(const std::vector<std::vector<PlacedPoint>>& views);

}  // namespace moiregauge::internal
