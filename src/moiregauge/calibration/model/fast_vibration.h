// SPDX-License-Identifier: Apache-2.0
// Vibration of a camera with a rolling shutter that is too fast for its model of motion.
#pragma once

#include <span>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

// Motion of the camera beyond its path, in the coordinates of RowDesign, and the frame that shows it.
struct MotionBeyondPath {
  BundleFrame frame;  // has rows
  Motion motion;
};

struct FastVibration {
  Extent<frame::Board> u_mm;  // standard uncertainty (k = 1) of a target in one frame
  double displaced_mm = 0.0;  // displacement of the references beyond the path, rms
  // The vibration is too large for its u: pose and motion of a frame can cancel at the references and be anything between
  // them.
  bool is_too_large = false;
};

// Returns the vibration within the readout. It is zero without motion beyond the path, or if the frames fit the scene
// (chi2_dof up to 2).
// Model: during readout a frame's motion has a rate and an acceleration. For a sine of angular frequency w and amplitude
// A, the next term is A (w t)^3 / 6 at a time t from the middle. At the references the acceleration moves the image by
// w t / 2 of what the rate moves it by, which yields w t. A is the displacement D beyond the path, rms over references
// and frames, divided by w t. For w t above 1 it is D: of a fast vibration, rate and acceleration show too low a
// frequency. u is at most D.
// The vibration is too large if w t exceeds 1 and D 0.01 pitch. It is also too large if D exceeds 0.05 pitch and
// chi2_dof 4.
//
// `chi2_dof`: chi2 per degree of freedom of the scene with these motions.
[[nodiscard]] FastVibration fast_vibration(const Site& site, std::span<const MotionBeyondPath> motions,
                                           double chi2_dof);

}  // namespace moiregauge::internal
