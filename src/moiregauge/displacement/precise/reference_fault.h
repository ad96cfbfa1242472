// SPDX-License-Identifier: Apache-2.0
// References that check each other: does one of them move? The geodesist's test for a single fault (Baarda 1968), with
// the scene solved anew without each reference in turn.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

struct ReferenceVerdict {
  bool verified = false;             // enough of them to name one that moves
  std::optional<std::size_t> moved;  // that reference (index in the site)
  bool doubtful = false;             // one of them moves, and it cannot be told which
  std::optional<long> since;         // frame from which on it stands elsewhere, if it moves by a step
};

// Six references show it, or five with a known camera. Four, or five without one, may show that one moves, not which:
// four leave two coordinates of eight after a frame's pose, and a slip that a pose and the lens imitate is not seen. A
// reference counts when it is seen in most frames. The scene is solved from the prior and from `start`, which holds every
// reference at rest, with the model of `start`. The one that costs less counts: either may end in a false valley.
[[nodiscard]] ReferenceVerdict test_references(const Site& site, const FrameSeries& frames, const ScenePrior& prior,
                                               const Scene& start, bool camera_known);

struct Movement {
  double mm = 0.0;
  double u_mm = 0.0;  // of both frames' noise, the scene known
};

// How far it went at most from where it was in the first frame, in the scene solved without it.
[[nodiscard]] Movement movement_of(Site site, const Scene& scene, const FrameSeries& frames, std::size_t marker);

}  // namespace moiregauge::internal
