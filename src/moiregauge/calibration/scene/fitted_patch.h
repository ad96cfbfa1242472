// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {

// Returns the whitened design matrix of a marker's grating at the result of a frame's fit. Its residual contains the
// fitted motion of a rolling shutter.
[[nodiscard]] inline PatchResidual::Design fitted_design(const PatchResidual& patch, const Scene& scene,
                                                         const BundleFrame& frame, const FrameFit& fit,
                                                         std::size_t marker) {
  PatchResidual::Design design =
      patch.design(numbers_of(scene), scene.markers[marker], TurnedPose(fit.pose), fit.shift[marker]);
  if (frame.rows)
    design.col(PatchColumn::kResidual) +=
        patch.root() * (frame.rows->by_marker[marker].leftCols<kMotionParameters>() * fit.motion);
  return design;
}

}  // namespace moiregauge::internal
