// SPDX-License-Identifier: Apache-2.0
// Evidence of a lens in `two-stage` footage. A homography through four references has no residual, whatever the lens.
// But their gratings are next to the circles, and every grating shows its own scale and rotation.
// All of this depends on one number for the run: kappa, the radial displacement at the corner of the image. The fit of
// kappa yields the error at the targets. It enters u and is not corrected, because the two-stage method is that of the
// paper.
#pragma once

#include <vector>

#include "moiregauge/observation/reference/observations.h"

namespace moiregauge::internal {

struct LensEvidence {
  double kappa_px = 0.0;  // radial displacement at the corner of the image
  double u_kappa_px = 0.0;
  // Per observation: error at each site marker for kappa = 1 px, after both stages, mm/px on the board.
  std::vector<std::vector<Extent<frame::Board>>> sensitivity;
  // Per observation: rms displacement of the references that neither kappa nor noise explains, mm.
  std::vector<double> unexplained_mm;
};

// Fits kappa to all observations (weighted least squares with a prior). `excess`: noise of their readings, relative to
// that of independent pixels; that of the reference frame's readings contains it.
[[nodiscard]] LensEvidence lens_evidence(const Reference& reference, const Observations& observations, double excess);

}  // namespace moiregauge::internal
