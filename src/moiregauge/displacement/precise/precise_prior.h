// SPDX-License-Identifier: Apache-2.0
// What `precise` knows of a run's scene before it has looked at the footage.
#pragma once

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// The site's word and the camera's, as wide as the user says; scales of prints as wide as their templates tell them.
[[nodiscard]] ScenePrior precise_prior(const Reference& reference, const SolveOptions& options);

}  // namespace moiregauge::internal
