// SPDX-License-Identifier: Apache-2.0
// What four points cannot absorb. A homography through four references leaves no residual there, whatever the lens
// does; but the references' gratings sit beside their circles, and inside every grating the lattice shows its own scale
// and rotation. All of it responds to a lens in a known way, so one number for the run, kappa, the radial displacement
// at the picture's corner, is fitted to all of it, and tells how large the error at the targets must be. It is not
// corrected here (the two-stage method is the paper's); it goes into u.
#pragma once

#include <vector>

#include "moiregauge/observation/reference/observations.h"

namespace moiregauge::internal {

struct LensEvidence {
  double kappa_px = 0.0;  // radial displacement at the picture's corner, px
  double u_kappa_px = 0.0;
  // Per observation: error at each site marker (mm on the board) for kappa = 1 px, after both stages.
  std::vector<std::vector<Extent<frame::Board>>> sensitivity;
  // Per observation: rms of the patches' displacements that neither kappa nor noise explains, mm.
  std::vector<double> unexplained_mm;
};

[[nodiscard]] LensEvidence lens_evidence(const Reference& reference, const Observations& observations);

}  // namespace moiregauge::internal
