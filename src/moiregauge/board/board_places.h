// SPDX-License-Identifier: Apache-2.0
// Identification of board positions from view to view. Views may differ by quarter rotations and show different
// parts of the board. The print's errors identify the positions, because they are the same in every view.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal {

// One point of a view: its column and row in the view's numbering (y up), and its residual on the board, in any unit.
struct PlacedPoint {
  int x = 0;
  int y = 0;
  Eigen::Vector2d off{0, 0};
};

// A view's points in a numbering common to all views. Without cells the view could not be identified, because the print
// shows no errors there.
struct MatchedView {
  int turns = 0;  // quarter rotations counter-clockwise, from the view's numbering to the common one
  std::vector<std::pair<int, int>> cells;
};
// Aligns the views by the correlation of their residuals. Starts with the largest view.
[[nodiscard]] std::vector<MatchedView> match_places(const std::vector<std::vector<PlacedPoint>>& views);

}  // namespace moiregauge::internal
