// SPDX-License-Identifier: Apache-2.0
// Apparent size: gratings that look larger or smaller than pitch and height state.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// A grating whose apparent size differs from that of its stated pitch and height.
struct SizeDeviation {
  std::size_t marker = 0;
  double larger = 0.0;     // relative to the size that the site states
  double nearer_mm = 0.0;  // if distance is the only cause
  double pitch_mm = 0.0;   // if pitch is the only cause
};

// Returns the markers whose apparent size differs from the site's. The limit is four u of the site, or 1 % for a target
// of unknown height. Markers whose distance follows from parallax are not among them.
// `calibration`: with the fits of its key frames.
[[nodiscard]] std::vector<SizeDeviation> size_deviations(const Site& site, const Calibration& calibration);

// Returns the u of a target's depth that covers both causes, mm. The solved depth is the one with the stated pitch. With
// the same chance it is wrong by all of nearer_mm, so the root of the mean square error is nearer / sqrt(2).
[[nodiscard]] double depth_u_mm(const SizeDeviation& deviation);

// Returns true if the standard uncertainty of the focal length is at most 10 % (chosen). Distances in mm are as uncertain,
// and so is the camera's foot on the board.
// `covariance`: of the scene with all parameters free.
[[nodiscard]] bool knows_focal_length(const Scene& scene, const Eigen::MatrixXd& covariance);

// Returns one line per deviation. Apparent size cannot separate pitch from distance, so the line states both as lengths.
[[nodiscard]] std::vector<std::string> apparent_size_notes(const Site& site, const Calibration& calibration,
                                                           std::span<const SizeDeviation> deviations);

}  // namespace moiregauge::internal
