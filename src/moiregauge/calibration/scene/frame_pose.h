// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

// Returns the start pose of a frame fit: the scene's camera sees the references' gratings there as read. Heights are
// neglected.
// From positions that are wrong by millimetres, a fit can otherwise end in the mirrored tilt.
// Fails (nothing): the gratings determine no homography.
[[nodiscard]] std::optional<Pose> pose_of(const Site& site, const Scene& scene, const BundleFrame& frame);

}  // namespace moiregauge::internal
