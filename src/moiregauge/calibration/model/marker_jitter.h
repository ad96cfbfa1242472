// SPDX-License-Identifier: Apache-2.0
// Marker jitter: a rigid shift of one marker per frame beyond noise. Causes are hot air, a moving wall or a creeping
// reference. The nine points of a grating share it, so it adds to two of 18 degrees of freedom of chi2. It enters the
// displacement fully.
#pragma once

#include <span>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

// Returns the marker jitter w, mm rms along each axis, estimated by moments from the residuals of the references. 0 if
// noise explains them.
//
//     E |Q' r|^2 = tr(Q' R Q) + w^2 |Q' R B|^2,   R = 1 - P
//
// r: whitened residuals of all frames. B: columns of the references' shifts. Q: orthonormal basis of B. P: projection
// on all that was solved (poses, motion, and the scene within its priors). R accounts for the share of the jitter that
// these absorb.
//
// `solution`: its frames have the weights that `fits` were made with.
// `already`: the jitter that these weights include, mm. It is returned if nothing determines a new value.
[[nodiscard]] double marker_jitter_mm(const Site& site, const BundleSolution& solution, std::span<const FrameFit> fits,
                                      const ScenePrior& prior, double already);

}  // namespace moiregauge::internal
