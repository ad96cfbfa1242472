// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

// The pose from which the scene's camera sees the prints of the frame's references where they were read, heights left
// out: where to begin a fit. From places that a site knows to a few millimetres only, a fit can end in the mirrored
// tilt. Nothing when they determine no homography.
[[nodiscard]] std::optional<Pose> pose_of(const Site& site, const Scene& scene, const BundleFrame& frame);

}  // namespace moiregauge::internal
