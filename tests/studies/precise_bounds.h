// SPDX-License-Identifier: Apache-2.0
// Cramér-Rao bounds of a displacement in one frame.
#pragma once

#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal::study {

// Both functions return the standard deviations of a target's displacement along the board's x and y, in um. Lens and
// marker positions are known, and the homography is fitted to the mean shifts of the references.

// Returns the bound by the fundamental of each grating over all its pixels (Rife and Boorstyn 1974).
[[nodiscard]] Extent<frame::Board> phase_bound_um(const simulator::Scenario& scenario, long frame);
// Returns the bound by all edges of each grating. The Fisher information of a shift is the sum over pixels of
// (d grey / d shift)^2 / variance. The derivative is the difference of two images without noise, with the grating moved
// by +-0.01 pitch.
[[nodiscard]] Extent<frame::Board> full_bound_um(const simulator::Scenario& scenario, long frame);

}  // namespace moiregauge::internal::study
