// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "moiregauge/calibration/scene.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge {

// The pose from which a camera with this f, cx, cy sees the board as `view` says: exact when the view is a picture of a
// plane by that camera, else the nearest rotation.
[[nodiscard]] Pose pose_of(const IdealFromBoard& view, const Camera& camera);

}  // namespace moiregauge
