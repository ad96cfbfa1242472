// SPDX-License-Identifier: Apache-2.0
// Zero of a run: the mean displacement over chosen frames, in place of the reference frame alone.
#pragma once

#include <optional>

#include "moiregauge/displacement/joint_errors.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal {

// Subtracts from every sample the mean over the target's ok rows in `zero` (in frames, not seconds).
// u follows from the joint errors. The noise of the mean replaces that of the reference frame, and what all frames share
// cancels.
// Budgets keep their parts. The scene's parts shrink with their sum, and `reference_frame` takes what is left.
// Returns a target without an ok row in `zero`, an index in the site; its samples stay unchanged. Nothing: all have one.
[[nodiscard]] std::optional<std::size_t> subtract_zero(const JointErrors& joint, const FrameRange& zero,
                                                       Samples& samples);

}  // namespace moiregauge::internal
