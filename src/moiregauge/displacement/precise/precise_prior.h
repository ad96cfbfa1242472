// SPDX-License-Identifier: Apache-2.0
// Prior of the scene for `precise`, before the footage is used.
#pragma once

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// Returns the prior from site, camera and options. The u of grating scales includes the error of their templates.
[[nodiscard]] ScenePrior precise_prior(const Reference& reference, const SolveOptions& options);

}  // namespace moiregauge::internal
