// SPDX-License-Identifier: Apache-2.0
// Steps of the frames while the scene is fixed. They need a third of the columns of a step of all unknowns.
#pragma once

#include <optional>
#include <span>

#include "moiregauge/calibration/scene/bundle_normal.h"

namespace moiregauge::internal {

// Returns `at` after the undamped Gauss-Newton step of every frame's pose, shifts and motion. The patches must be in
// the order of their frames.
// Fails (nothing): a frame's patches do not determine its pose.
[[nodiscard]] std::optional<BundleState> step_of_frames(std::span<const BundlePatch> patches, const BundleState& at);

}  // namespace moiregauge::internal
