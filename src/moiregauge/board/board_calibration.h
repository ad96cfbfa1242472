// SPDX-License-Identifier: Apache-2.0
// A camera from photographs of one flat regular board (docs/methods/calibrate.md): the bundle of the measurement, with
// points of a lattice in place of prints.
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
  double u_px = 0.0;         // of each coordinate, as far as its own pixels tell
  double diameter_mm = 0.0;  // of a dot, whose `at` is the centre of its ellipse; 0: a point
  int column = 0;            // of the lattice, as the view counts them
  int row = 0;
};

// One photograph. Where the board's origin is, and by which quarter turn its axes lie, may differ from view to view.
struct BoardView {
  int width = 0;  // px
  int height = 0;
  std::vector<BoardPointSeen> points;
};

// The board's middle is its origin, y up.
[[nodiscard]] BoardView board_view(const SeenBoard& board, double pitch_mm, int width, int height);

struct BoardOptions {
  bool k3 = false;  // solve it too
};

// Rms length, px, of what is left when a homography maps the board onto a view: of the four outermost points, judged by
// all the others; and the best one for all points. As seen, and with the lens taken out.
struct BoardNull {
  double corners_seen = 0.0, corners = 0.0;
  double lattice_seen = 0.0, lattice = 0.0;
};

struct CalibratedView {
  std::string left_out;       // why, in words; empty: it was used, and the rest holds
  double tilt_rad = 0.0;      // between the board's normal and the line of sight to its middle
  double rms_px = 0.0;        // reprojection error, rms length
  double misfit_ratio = 1.0;  // scatter under the common camera by that under the view's own, both by their freedom
  int outliers = 0;           // points that fit no picture of a flat lattice, excluded
  BoardNull null;
};

struct BoardCalibration {
  Camera camera;  // fx = fy
  // Standard uncertainties, everything free; 0: held at 0. From three views on never less than what leaving out each
  // view in turn shows, for residuals have much in common within a view (a bent board, a bias of its corners).
  std::array<double, kCameraParameters> u{};
  SceneModel model;  // radial, tangential: taken or found needless
  bool k3 = false;
  double chi2_dof = 0.0;  // by the points' own noise
  double point_px = 0.0;  // standard uncertainty of a point beyond that noise, from the residuals
  double print_mm = 0.0;  // of a point's place on the board, as far as it is the same in several views
  double patch_px = 0.0;  // of what the points of one ninth of the board share
  double rms_px = 0.0;    // reprojection error over all views, rms length; errors of the print are in it
  int points = 0;
  int matched = 0;                    // views whose points were recognised by the print's own errors
  std::vector<CalibratedView> views;  // one per view given
};

// fails      in words: no view is usable, or no camera explains them
[[nodiscard]] tl::expected<BoardCalibration, std::string> calibrate_board(std::span<const BoardView> views,
                                                                          const BoardOptions& options);

// The nulls of one view under a camera.
[[nodiscard]] BoardNull board_null(const BoardView& view, const Camera& camera);

}  // namespace moiregauge::internal
