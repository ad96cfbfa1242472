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
// Model: in a scene solved without the statement, a target's shifts in those frames about one common place, with the
// noise of every frame and the covariance of the scene they share (generalised least squares). Apparent movement that
// another depth, lens or scale within its uncertainty explains is therefore no movement. Frames in which the target's
// row would not be `ok` do not count.
// Error: a true rest is refused about once in 10^4 runs, as long as u is right within 12 %.
[[nodiscard]] std::optional<MovedAtRest> moved_at_rest(const Reference& reference, const Observations& observations,
                                                       const std::vector<std::size_t>& place,
                                                       const PreciseScene& without_claim, const FrameRange& rest);

}  // namespace moiregauge::internal
