// SPDX-License-Identifier: Apache-2.0
// Tests the user's statement that no target moves in some frames (`--rest`), before anything is solved with it.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/displacement/bundle_frames.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/displacement/precise/precise_scene.h"

namespace moiregauge::internal {

// Returns the target that moves most in the frames of `rest`, if one moves by more than its uncertainty allows.
// Model: generalised least squares in a scene solved without the statement. The shifts of a target in those frames have
// one common position. Their covariance is the noise of every frame and the scene they share. Apparent movement by
// another depth, lens or scale within its uncertainty does not count. Only frames in which the target's row would be
// `ok` count.
// Error: a true statement is refused about once in 10^4 runs, if u is right within 12 %.
[[nodiscard]] std::optional<MovedAtRest> moved_at_rest(const Reference& reference, const Observations& observations,
                                                       const std::vector<std::size_t>& place,
                                                       const PreciseScene& without_claim, const FrameRange& rest);

}  // namespace moiregauge::internal
