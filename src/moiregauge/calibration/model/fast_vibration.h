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

// Returns the standard uncertainty (k = 1, mm) of a target in one frame from vibration within the readout.
// Model: during readout a frame's motion has a rate and an acceleration. For a sine of angular frequency w and amplitude
// A, the next term is A (w t)^3 / 6 at a time t from the middle. At the references the acceleration moves the image by
// w t / 2 of what the rate moves it by, which yields w t. A is the displacement D beyond the path, rms over references
// and frames, divided by w t. For w t above 1 it is D: of a fast vibration, rate and acceleration show too low a
// frequency. The result is at most D.
// Zero without motion beyond the path.
[[nodiscard]] Extent<frame::Board> u_of_fast_vibration(const Site& site, std::span<const MotionBeyondPath> motions);

}  // namespace moiregauge::internal
