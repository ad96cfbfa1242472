// SPDX-License-Identifier: Apache-2.0
// State of a board calibration: views in use, their outliers and positions, and the current solution.
#pragma once

#include <vector>

#include "moiregauge/board/board_bundle.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

struct BoardWork {
  std::vector<const BoardView*> views;
  std::vector<std::vector<bool>> is_outlier;
  std::vector<std::vector<int>> place;  // position of every point of the views, or kNoPlace
  std::vector<int> turns;               // for every view: quarter rotations of its board coordinates
  int places = 0;
  int matched = 0;        // views whose points have positions
  double point_px = 0.5;  // scatter of a point beyond its own noise; start value, then from the residuals
  double print_mm = 0.0;  // scatter of single positions
  double patch_mm = 0.0;  // scatter common to one ninth of the board
  BoardPrior prior;
  BoardState state;
  BoardData data;
};

[[nodiscard]] Camera camera_of(const CameraBlock& block, int width, int height);
[[nodiscard]] IdealFromBoard view_of_pose(const Pose& pose, const CameraBlock& camera);

// Returns the points in use. Dots are corrected from the centre of their ellipse to the image of their centre.
[[nodiscard]] BoardData data_of(const BoardWork& work);

struct BoardScatter {
  double chi2 = 0.0;
  double dof = 0.0;
};
// Returns chi2 and its degrees of freedom, with point_px added to the points' own noise.
[[nodiscard]] BoardScatter scatter_of(const BoardWork& work, const BoardModel& model, double point_px);
// Returns the point_px with which chi2 equals its degrees of freedom, px. 0 if noise explains the points.
[[nodiscard]] double scatter_beyond_noise(const BoardWork& work, const BoardModel& model);

// Marks points whose residual exceeds five standard deviations, estimated from the median residual, and 0.1 px.
void find_outliers(BoardWork& work);

// Returns the scatter common to the points of one ninth of the board, px.
[[nodiscard]] double patch_scatter(const BoardWork& work);

// Identifies positions that several views show. Solves the print error of each, together with everything else. Print
// errors are the same in every view and would otherwise imitate a lens.
void solve_with_places(BoardWork& work, const BoardModel& model);

}  // namespace moiregauge::internal
