// SPDX-License-Identifier: Apache-2.0
// The views that count, on their way to a solution of board_calibration.h.
#pragma once

#include <vector>

#include "moiregauge/board/board_bundle.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

struct BoardWork {
  std::vector<const BoardView*> views;
  std::vector<std::vector<bool>> is_outlier;
  std::vector<std::vector<int>> place;  // of every point of the views, or kNoPlace
  std::vector<int> turns;               // of every view: quarters by which its board coordinates are turned
  int places = 0;
  int matched = 0;        // views whose points have places
  double point_px = 0.5;  // scatter of a point beyond its own noise, until the residuals have said it
  double print_mm = 0.0;  // of a place by itself
  double patch_mm = 0.0;  // of a patch of places
  BoardPrior prior;
  BoardState state;
  BoardData data;
};

[[nodiscard]] Camera camera_of(const CameraBlock& block, int width, int height);
[[nodiscard]] IdealFromBoard view_of_pose(const Pose& pose, const CameraBlock& camera);

// The points that count, as points: the offset of an ellipse's centre from the image of the circle's centre taken out.
[[nodiscard]] BoardData data_of(const BoardWork& work);

struct BoardScatter {
  double chi2 = 0.0;
  double dof = 0.0;
};
// chi2 with point_px added to the points' own noise.
[[nodiscard]] BoardScatter scatter_of(const BoardWork& work, const BoardModel& model, double point_px);
// The point_px with which chi2 is its degrees of freedom; 0 where noise explains the points.
[[nodiscard]] double scatter_beyond_noise(const BoardWork& work, const BoardModel& model);

// Marks the points further off than `work.state` and the others' median explain.
void find_outliers(BoardWork& work);

// What the points of one ninth of the board share, px.
[[nodiscard]] double patch_scatter(const BoardWork& work);

// Recognises places that several views show and solves how far the print is off at each of them, together with
// everything else: a print's errors are the same in every view and must not pass for the lens.
void solve_with_places(BoardWork& work, const BoardModel& model);

}  // namespace moiregauge::internal
