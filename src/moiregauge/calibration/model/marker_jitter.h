// SPDX-License-Identifier: Apache-2.0
// Markers that do not stand still against one another, each as a whole: hot air between them and the camera, a wall
// that works, a reference that creeps. The nine points of a print agree on it, so it hides in chi2, of which it fills
// two degrees of freedom in eighteen; but it goes into the result whole.
#pragma once

#include <span>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

// By how much every print is displaced in every frame, mm along each axis, rms, if each goes its own way: what
// the references, each taken as a whole, miss the scene by beyond their noise. 0 where that may be chance.
//
//   E |Q' r|^2 = tr(Q' R Q) + w^2 |Q' R B|^2,   R = 1 - P
//
// r the whitened residuals of all frames, B the columns of shifts of the references, Q an orthonormal basis of them, P
// the projection on what was solved: poses, shifts, and the scene within its priors. What poses and scene take up of it
// is accounted for by R, in expectation: the estimate is that of moments.
//
// frames   with the weights of `fits`
// already  the wander that these weights allow for
[[nodiscard]] double marker_jitter_mm(const Site& site, const Scene& scene, std::span<const BundleFrame> frames,
                                      std::span<const FrameFit> fits, const ScenePrior& prior, double already);

}  // namespace moiregauge::internal
