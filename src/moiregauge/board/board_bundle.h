// SPDX-License-Identifier: Apache-2.0
// The least squares of board_calibration.h: camera and poses from points of a plane.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/board/board_calibration.h"

namespace moiregauge::internal {

// Lens terms that are free; f, cx and cy always are.
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
// Hardly anything: a lens of any kind that a plane can be seen through. f: where the search for it begins, px.
[[nodiscard]] BoardPrior board_prior(int width, int height, double f);

inline constexpr int kNoPlace = -1;

// What is solved from: points of the views that count, the ellipses' offset taken out, one standard uncertainty each.
struct BoardData {
  std::vector<std::vector<BoardPointSeen>> views;
  std::vector<std::vector<double>> u_px;
  std::vector<std::vector<int>> place;  // of each point among those that several views show, or kNoPlace
  int places = 0;
  double print_mm = 0.0;  // prior of how far a place is from where it should be
};

struct BoardState {
  CameraBlock camera{};
  std::vector<Pose> poses;
  std::vector<std::array<double, 2>> offset;  // of each place, mm
  double penalised_cost = 0.0;                // data and prior
  bool solved = false;
};
[[nodiscard]] BoardState solve_board(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                     const BoardState& start);

// Seen less projected; the place's own offset is not taken out.
[[nodiscard]] Extent<frame::Image> residual_of(const BoardState& state, std::size_t view, const BoardPointSeen& point);

// Standard uncertainties of the camera's parameters. `patch_px`: what the points of one patch share (patch_of), in the
// same patch of every view, since it is one print that they show.
[[nodiscard]] CameraBlock uncertainty_of(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                         const BoardState& state, double patch_px);

// Returns the delete-one-view jackknife (Quenouille 1956; Efron and Stein 1981): u^2 = (n-1)/n sum (p_v - mean p)^2, p_v
// solved without view v. Zeros: fewer than three views, or one of the solutions failed.
[[nodiscard]] CameraBlock jackknife_uncertainty(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                                const BoardState& state);

// Returns by view the scatter under the common camera divided by that under a camera solved from the view alone.
// Near 1 for views of one camera, whatever the print has wrong.
[[nodiscard]] std::vector<double> misfit_ratios(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                                const BoardState& state);

// Which ninth of the view's board a point lies in: 0 to 8.
inline constexpr std::size_t kBoardPatches = 9;
[[nodiscard]] std::vector<std::size_t> patch_of(std::span<const BoardPointSeen> points);

}  // namespace moiregauge::internal
