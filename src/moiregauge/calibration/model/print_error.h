// SPDX-License-Identifier: Apache-2.0
// Print error: the excess of residuals over noise. Gratings are rough, curl a little, and their templates are not
// perfect. On a photographed board the nine points of a grating have residuals of 0.02 px, where noise predicts 0.003
// px.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

struct PrintError {
  // Standard uncertainty (k = 1) of each coordinate of the nine points. It counts once per point and once in common,
  // because errors of a grating extend over its neighbourhood.
  double points_mm = 0.0;
  // Common to the nine points only: the marker jitter.
  double marker_jitter_mm = 0.0;
  // True noise of the points relative to the noise from pixel residuals (ratio of u).
  double noise_share = 1.0;
};

// Returns the frames with this error included in the points' covariance.
[[nodiscard]] std::vector<BundleFrame> with_print_error(const Site& site, std::span<const BundleFrame> frames,
                                                        const PrintError& error);

// Returns the print error u_p in mm: with it chi2 equals its degrees of freedom. It is 0 if noise explains chi2, and at
// most 0.05 pitch. All parameters must be free in the scene. Otherwise an excluded height counts as print error.
//
// `frames`: covariance of noise and marker jitter only, with solved poses and shifts.
// `fits`: fits of these frames to the scene, with any print error.
// `prior`: of the scene. Parameters that the footage determines cost degrees of freedom.
[[nodiscard]] double print_error_mm(const Site& site, const Scene& scene, std::span<const BundleFrame> frames,
                                    std::span<const FrameFit> fits, const ScenePrior& prior);

// Returns the true noise of the points relative to that from the pixel residuals (ratio of u, at most 1). Residuals
// also contain the template's errors at edges, which are the same in all frames. Then chi2 is below its degrees of
// freedom. 100 more degrees of freedom favour the stated noise in short runs.
[[nodiscard]] double noise_share(const Site& site, const SceneModel& model, std::span<const FrameFit> fits,
                                 const ScenePrior& prior);

}  // namespace moiregauge::internal
