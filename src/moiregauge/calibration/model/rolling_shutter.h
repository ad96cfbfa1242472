// SPDX-License-Identifier: Apache-2.0
// Scene, camera's path and readout of footage from a rolling shutter, solved in turn.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/calibration/rolling_shutter/row_motion.h"

namespace moiregauge::internal {

// Readout as given by the user: as exact as a data sheet's number.
inline constexpr double kGivenReadout = 0.03;  // relative standard uncertainty

struct Shutter {
  Calibration calibration;
  FrameSeries frames;  // all of them, points set back
  // What the targets' own motion leaves open at the time of their rows; by frame, then site marker, mm.
  std::vector<std::vector<Extent<frame::Board>>> u_target;
  double readout_s = 0.0;  // below zero: rows are read from the picture's other end
  double u_readout_s = 0.0;
  double motion_cost = 0.0;  // of the key frames: chi2 of the motions' prior
  double interval_s = 0.0;   // between frames, median
  bool bounded = false;      // no readout between the shortest and the time between frames fits best
  std::string problem;       // why nothing was solved; then nothing else holds
};

// Rounds of: every frame's pose in the scene; a spline through the poses (smooth_path), whose rates set the points back;
// the readout, unless the motion tells nothing of it; the scene (calibrate). What a frame's own points say against the
// spline widens the motions' prior, component by component: vibrations above half the frame rate look slow in the poses.
//
// frames    as read, the reference frame first; without times frames count as seconds
// key       of them, for the scene; the first one among them
// readout   given, or nothing known
[[nodiscard]] Shutter solve_shutter(const Site& site, const FrameSeries& frames, std::span<const std::size_t> key,
                                    const ScenePrior& prior, std::optional<double> readout_s);

// Does it pay: is chi2 of the key frames lower by more than what their motions and the readout take up (Schwarz 1978),
// and by a good part of what noise does not explain?
// at_once   the scene as solved with all rows read at once
[[nodiscard]] bool is_justified(const Shutter& shutter, const Calibration& at_once);

}  // namespace moiregauge::internal
