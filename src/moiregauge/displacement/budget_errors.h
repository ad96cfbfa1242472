// SPDX-License-Identifier: Apache-2.0
// Joint errors of a method whose budget does not know what targets share.
#pragma once

#include "moiregauge/displacement/joint_errors.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// Returns the joint errors that the budgets of the samples give, for each value alone. Noise and references are
// independent from frame to frame. The reference frame's part is the same in all frames. The rest may be either.
// `samples`: by observation, then target.
[[nodiscard]] JointErrors budget_errors(const Site& site, const Samples& samples);

}  // namespace moiregauge::internal
