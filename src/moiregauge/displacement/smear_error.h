// SPDX-License-Identifier: Apache-2.0
// Error of a position by uneven movement within the exposure (smear). A frame shows the mean image over its exposure. Its
// phase is that of the mean position only if the path is symmetric about its mean, as at constant speed. The difference
// grows with the third moment of the path. F is the weight of the harmonics, and K = 2 pi / pitch.
//
//     dx = F K^2 / 6 <(x - <x>)^3>
//
// The movement is that of the camera c and the target's own s. A camera is nearly at constant speed within an exposure,
// which has no third moment. What remains is <s^3> + 3 <c^2 s>. Blur shows the variances only. So the terms are replaced by
// their standard deviations for paths of random phase (docs/methods/precise/uncertainty.md).
#pragma once

#include <vector>

#include "moiregauge/calibration/scene/frame_series.h"

namespace moiregauge::internal {

// Standard uncertainties by smear in mm, by frame and site marker. Empty: no target has any that matters.
using SmearError = std::vector<std::vector<Extent<frame::Board>>>;

// Returns the uncertainty of each target's position by smear. The variance of a path along an axis follows from the
// amplitude of the grating, relative to its light. The target's own part is what exceeds that of the references.
// `frames`: the reference frame first. What a codec loses looks like blur, too, so u grows with it.
// Error: for vibrations of 0.2 to 0.9 periods per exposure it is 0.7 to 15 times the rms error. More periods are alike in
// all frames, and show less.
[[nodiscard]] SmearError smear_error(const Site& site, const FrameSeries& frames);

}  // namespace moiregauge::internal
