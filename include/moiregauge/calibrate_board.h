// SPDX-License-Identifier: Apache-2.0
// Calibration of a camera and its lens from photographs of one flat printed board.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/camera.h"
#include "moiregauge/units.h"

namespace moiregauge {

struct CalibratedView {
  std::string file;
  std::string excluded;  // reason; empty: the photograph was used
  double rms_px = 0.0;   // reprojection error
};

struct CalibratedCamera {
  Camera camera;        // fx = fy
  Camera u;             // standard uncertainties (k = 1); 0: fixed at 0
  double rms_px = 0.0;  // reprojection error over all views
  std::vector<CalibratedView> views;
};

// Solves the camera from photographs of a board of dots, squares, crossed lines or a checkerboard.
// `photos`: files, or folders of them. `pitch`: period of the board; two squares of a checkerboard.
// Model: bundle adjustment of docs/methods/calibrate.md. Units: px.
// Fails: an unreadable photograph (kInput), or no usable view (kRefused).
// Error: `u`, from three views on at least the jackknife over views.
[[nodiscard]] MOIREGAUGE_API Expected<CalibratedCamera> calibrate_board(const std::vector<std::string>& photos,
                                                                        Millimetres pitch);

}  // namespace moiregauge
