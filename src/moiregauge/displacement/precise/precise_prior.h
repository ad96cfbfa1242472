// SPDX-License-Identifier: Apache-2.0
// Prior of the scene for `precise`, before the footage is used.
#pragma once

#include <vector>

#include "moiregauge/calibration/model/target_movement.h"
#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// Returns the prior from site, camera and options. The u of grating scales includes the error of their templates.
[[nodiscard]] ScenePrior precise_prior(const Reference& reference, const SolveOptions& options);

// Returns for every marker the point whose displacement is measured if it rotates. It is the symmetry point of its
// grating nearest to the middle of the print. Without one it is where the site has the grating, and its uncertainty
// includes the distance at which the reference frame shows the grating.
// `then`: fit of the reference frame.
[[nodiscard]] std::vector<RotationCentre> rotation_centres(const Reference& reference, const FrameFit& then);

}  // namespace moiregauge::internal
