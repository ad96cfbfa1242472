// SPDX-License-Identifier: Apache-2.0
// Rolling shutter: scene, camera path and readout time, solved in turn.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/calibration/model/fast_vibration.h"
#include "moiregauge/calibration/model/target_movement.h"
#include "moiregauge/calibration/rolling_shutter/row_motion.h"

namespace moiregauge::internal {

// Relative standard uncertainty of a given readout time: that of a data sheet. Chosen.
inline constexpr double kGivenReadout = 0.03;

struct Shutter {
  Calibration calibration;
  FrameSeries with_movements;  // all frames, points at frame time
  FrameSeries frames;          // the same without the movements of targets beyond displacement
  // Uncertainty from the target's motion during readout and from fast vibration of the camera (`vibration`), mm,
  // by frame, then site marker.
  std::vector<std::vector<Extent<frame::Board>>> u_target;
  FastVibration vibration;
  double readout_s = 0.0;  // negative: the readout starts at the opposite end of the image
  double u_readout_s = 0.0;
  double motion_cost = 0.0;  // chi2 of the motions' prior, over the key frames
  double interval_s = 0.0;   // median time between frames
  bool bounded = false;      // the readout time is at one of its limits
  std::string problem;       // reason of a failure; all other fields are then invalid
};

// Footage to solve, and what is known of it.
struct ShutterTask {
  const Site& site;
  const FrameSeries& frames;         // as read, the reference frame first
  std::span<const std::size_t> key;  // indices of the frames for the scene, with the reference frame
  const ScenePrior& prior;
  std::optional<double> readout_s;  // given. If not, both directions are tried, unless the first is above 3 u
  // Removes the movements of targets beyond displacement at frame time: in frames as read, the rolling shutter shears
  // the gratings of targets like a movement. Null: the targets are only displaced.
  std::shared_ptr<const MovementRemoval> movements = nullptr;
  // chi2/dof of the scene without a readout time. A search that leaves most of it ends soon. Zero if not known.
  double chi2_dof_at_once = 0.0;
};

// Solves path, readout time and scene in turn, at most ten rounds and a last one to full convergence. A smoothing
// spline through the poses (smooth_path) yields rates, which correct the points to frame time. The frames' own points
// inflate the process noise per component: vibrations above half the frame rate look slow in the poses.
// Fails (problem is not empty): too few frames for a motion, no scene could be solved, or no readout time explains the
// frames.
//
// Without time stamps the frame number counts as seconds.
[[nodiscard]] Shutter solve_shutter(const ShutterTask& task);

// Returns true if a rolling shutter explains the footage better. The cost of the key frames must fall by more than
// ln(dof) per effective parameter (Schwarz 1978). It must also fall by a quarter of the excess over noise. The readout
// time must exceed 3 u and not be at a limit.
// `at_once`: the scene solved as for a global shutter.
[[nodiscard]] bool is_justified(const Shutter& shutter, const Calibration& at_once);

}  // namespace moiregauge::internal
