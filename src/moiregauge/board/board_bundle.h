// SPDX-License-Identifier: Apache-2.0
// Bundle adjustment of a board calibration: camera and poses from points of a plane.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/board/board_calibration.h"

namespace moiregauge::internal {

// Free lens terms. f, cx and cy are always free.
struct BoardModel {
  bool radial = false;
  bool tangential = false;
  bool k3 = false;
};
[[nodiscard]] std::array<bool, kCameraParameters> free_of(const BoardModel& model);

using CameraBlock = std::array<double, kCameraParameters>;

struct BoardPrior {
  CameraBlock mean{};
  CameraBlock u{};
};
// Returns a wide prior that suits any lens but a fisheye. `f`: start value of the focal length, px.
[[nodiscard]] BoardPrior board_prior(int width, int height, double f);

inline constexpr int kNoPlace = -1;  // a point whose position only one view shows

// Points of the views in use, corrected from ellipse centre to circle centre, with their standard uncertainties.
struct BoardData {
  std::vector<std::vector<BoardPointSeen>> views;
  std::vector<std::vector<double>> u_px;
  std::vector<std::vector<int>> place;  // position of each point among those in several views, or kNoPlace
  int places = 0;
  double print_mm = 0.0;  // prior u of a position's offset on the board, mm
};

struct BoardState {
  CameraBlock camera{};
  std::vector<Pose> poses;
  std::vector<std::array<double, 2>> offset;  // for each position on the board, mm
  double penalised_cost = 0.0;                // chi2 of data (Huber's loss) and priors
  bool solved = false;
};
// Solves camera, poses and offsets from `start` (Ceres, Huber's loss beyond 4 u).
// Fails (solved = false): Ceres finds no usable solution, or f is not positive.
[[nodiscard]] BoardState solve_board(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                     const BoardState& start);

// Returns the detected minus the projected point, px. The offset of its position on the board is not subtracted.
[[nodiscard]] Extent<frame::Image> residual_of(const BoardState& state, std::size_t view, const BoardPointSeen& point);

// Returns the standard uncertainties of the camera's parameters; 0 for fixed ones.
// `patch_px`: error common to the points of one ninth of the board (patch_of). It is the same in that ninth of every
// view, because all views show one print.
[[nodiscard]] CameraBlock uncertainty_of(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                         const BoardState& state, double patch_px);

// Returns the delete-one-view jackknife (Quenouille 1956; Efron and Stein 1981): u^2 = (n - 1) / n sum (p_v - mean
// p)^2. Here p_v is solved without view v.
// Fails (zeros): there are fewer than three views, or one of the solutions failed.
[[nodiscard]] CameraBlock jackknife_uncertainty(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                                const BoardState& state);

// Returns for each view the scatter about the common camera divided by that about a camera solved from this view alone.
// It is near 1 for views of one camera, whatever errors the print has.
[[nodiscard]] std::vector<double> misfit_ratios(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                                const BoardState& state);

// Returns for each point the ninth of the view's board that contains it: 0 to 8.
inline constexpr std::size_t kBoardPatches = 9;
[[nodiscard]] std::vector<std::size_t> patch_of(std::span<const BoardPointSeen> points);

}  // namespace moiregauge::internal
