// SPDX-License-Identifier: Apache-2.0
// Computes the two-stage method on exact points: its result if pixels lose nothing. The homographies are the test's
// own, the projections are the simulator's.
#pragma once

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::test {

// k1 of the rig's lens, by its distortion at the full sensor's corner.
inline constexpr double kMinusOnePercent = -0.0225;

enum class Stages { kCirclesOnly, kBoth };

// Returns the error of the target's displacement (mm) by the published method, at `frame` relative to
// `reference_frame`. Steps: the circles give a homography; the gratings' displacements, added AT THE CIRCLES, give the
// second one, which gives the target.
[[nodiscard]] Extent<frame::Board> exact_error(const simulator::Scenario& scenario, long frame, long reference_frame,
                                               Stages stages);

}  // namespace moiregauge::internal::test
