// SPDX-License-Identifier: Apache-2.0
// Outlier test of the references (Baarda 1968, a single outlier). Each reference in turn becomes a target, and the
// scene is solved again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/displacement/precise/reference_slip.h"

namespace moiregauge::internal {

// Returns true if this number of references can name the one that moves.
[[nodiscard]] constexpr bool can_name_reference(std::size_t references, bool camera_known) {
  return references >= 6 || (references == 5 && camera_known);
}

struct ReferenceVerdict {
  bool verified = false;             // true if the layout can name a moving reference
  std::optional<std::size_t> moved;  // the moving reference (index in the site)
  bool doubtful = false;             // one of them moves, and it is unknown which
  std::optional<StepPlace> step;     // if it moves by a step
};

// Tests whether a reference moves. Only references that were read in most frames count.
// Six references can name it, or five with a known camera. Five without a camera, or four, may show a movement but not
// name it. Four leave two of eight coordinates after the pose, so they miss a step that pose and lens imitate.
// The scene is solved from the prior and from `start`, with the model of `start`, and the solution with the lower cost
// counts.
[[nodiscard]] ReferenceVerdict test_references(const Site& site, const FrameSeries& frames, const ScenePrior& prior,
                                               const Scene& start, bool camera_known);

struct Movement {
  double mm = 0.0;
  double u_mm = 0.0;  // standard uncertainty from the noise of both frames, for a known scene
};

// Returns the largest displacement of a reference since the first frame, in the scene solved without it.
[[nodiscard]] Movement movement_of(Site site, const Scene& scene, const FrameSeries& frames, std::size_t marker);

}  // namespace moiregauge::internal
