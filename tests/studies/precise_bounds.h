// SPDX-License-Identifier: Apache-2.0
// The least scatter that a frame allows a displacement to have, whatever the estimator.
#pragma once

#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal::study {

// Standard deviations along the board's x and y of a target's displacement in one frame, the camera's lens and the
// markers' places known, the homography from the references' mean shifts (um).
//
// Phase bound: the fundamental of each grating over every pixel of its print (Rife and Boorstyn 1974).
[[nodiscard]] Extent<frame::Board> phase_bound_um(const simulator::Scenario& scenario, long frame);
// Full bound: every printed edge. Information of a shift = sum over pixels of (d grey / d shift)^2 / variance, the
// derivative taken from two noise-free pictures of the print moved by a hundredth of its pitch.
[[nodiscard]] Extent<frame::Board> full_bound_um(const simulator::Scenario& scenario, long frame);

}  // namespace moiregauge::internal::study
