// SPDX-License-Identifier: Apache-2.0
// What no noise explains. Prints are rough, curl a little, and their templates are not perfect. On photographs of a
// printed board the nine points of a patch miss the scene by 0.02 px where the pixels' noise says 0.003 px.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

struct PrintError {
  double points_mm = 0.0;  // u (k = 1) in each coordinate of each of the nine points, and once more in common to the
                           // nine: what is wrong with a print is wrong in its neighbourhood too
  double marker_jitter_mm = 0.0;  // in common to the nine alone: where the print hangs in one frame (marker_jitter.h)
  double noise_share = 1.0;       // u of the points' noise, relative to what the pixels' residuals have it
};

// The patches of frames with that in their covariance.
[[nodiscard]] std::vector<BundleFrame> with_print_error(const Site& site, std::span<const BundleFrame> frames,
                                                        const PrintError& error);

// The points_mm with which chi2 is what its degrees of freedom explain: 0 where noise alone does. Ask it of a scene with
// everything free, or a height that was left out passes for a bad print.
//
// frames   with the covariance of noise alone, and of their wander, poses and shifts as solved
// fits     of these frames against the scene, whatever print error they were made with
// prior    of the scene's parameters: those that the footage determines cost degrees of freedom
[[nodiscard]] double print_error_mm(const Site& site, const Scene& scene, std::span<const BundleFrame> frames,
                                    std::span<const FrameFit> fits, const ScenePrior& prior);

// What part (1 or less, of u) of the noise that the pixels' residuals amount to scatters from frame to frame: they hold
// what the template misses at every edge too, which is much the same in all frames. chi2 is then less than its degrees
// of freedom. A hundred degrees more are taken to say that noise is all there is.
[[nodiscard]] double noise_share(const Site& site, const SceneModel& model, std::span<const FrameFit> fits,
                                 const ScenePrior& prior);

}  // namespace moiregauge::internal
