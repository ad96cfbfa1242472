// SPDX-License-Identifier: Apache-2.0
// Calibration of a camera from photographs of one flat regular board (docs/methods/calibrate.md). It is the bundle
// adjustment of the measurement, with lattice points instead of gratings.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/board/seen_board.h"
#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct BoardPointSeen {
  BoardPoint board;          // mm
  ImagePoint at;             // px
  double u_px = 0.0;         // u of each coordinate from the point's own pixels
  double diameter_mm = 0.0;  // a dot's diameter; `at` is then its ellipse's centre; 0: a point
  int column = 0;            // in the lattice, by this view's numbering
  int row = 0;
};

// One photograph. Origin and axes of the board may differ between views, the axes by quarter rotations.
struct BoardView {
  int width = 0;  // px
  int height = 0;
  std::vector<BoardPointSeen> points;
};

// Returns the board's points in mm. The origin is the board's middle, y is up.
[[nodiscard]] BoardView board_view(const SeenBoard& board, double pitch_mm, int width, int height);

struct BoardOptions {
  bool k3 = false;  // also solve k3
};

// Rms residual, px, after a homography maps the board onto a view. `corners`: through the four outermost points, tested
// at all others. `lattice`: best fit to all points. `_seen`: image as photographed; otherwise the lens is removed.
struct BoardNull {
  double corners_seen = 0.0, corners = 0.0;
  double lattice_seen = 0.0, lattice = 0.0;
};

struct CalibratedView {
  std::string excluded;   // reason; empty: the view was used, and the other fields are valid
  double tilt_rad = 0.0;  // between the board's normal and the line of sight to its middle
  double rms_px = 0.0;    // reprojection error, rms length
  // Scatter about the common camera divided by that about the view's own camera, both per degree of freedom.
  double misfit_ratio = 1.0;
  int outliers = 0;  // excluded points that fit no image of a flat lattice
  BoardNull null;
};

struct BoardCalibration {
  Camera camera;  // fx = fy
  // Standard uncertainties with all parameters free; 0: fixed at 0. From three views on they are at least the jackknife
  // over views. Residuals are correlated within a view (a bent board, a bias of its corners).
  std::array<double, kCameraParameters> u{};
  SceneModel model;  // radial and tangential: accepted by BIC
  bool k3 = false;
  double chi2_dof = 0.0;  // relative to the points' own noise
  double point_px = 0.0;  // scatter of a point beyond that noise, from the residuals
  double print_mm = 0.0;  // scatter of positions on the board, common to several views
  double patch_px = 0.0;  // scatter common to the points of one ninth of the board
  double rms_px = 0.0;    // reprojection error over all views, rms length; includes print errors
  int points = 0;
  int matched = 0;                    // views whose positions were identified by the print's errors
  std::vector<CalibratedView> views;  // one per view given
};

// Solves the camera from views of one board.
// Fails (error text): no view is usable, or no camera fits them.
[[nodiscard]] tl::expected<BoardCalibration, std::string> calibrate_board(std::span<const BoardView> views,
                                                                          const BoardOptions& options);

// Returns the nulls of one view with this camera. Zeros: the view has fewer than five points.
[[nodiscard]] BoardNull board_null(const BoardView& view, const Camera& camera);

}  // namespace moiregauge::internal
