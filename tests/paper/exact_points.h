// SPDX-License-Identifier: Apache-2.0
// The two-stage method on exact points: what it must give when nothing is lost in pixels. The homographies here are the
// test's own; the projections are the simulator's.
#pragma once

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::test {

// k1 of the rig's lens, by its distortion at the full sensor's corner.
inline constexpr double kMinusOnePercent = -0.0225;

enum class Stages { kCirclesOnly, kBoth };

// Error of the target's displacement (mm) of the published method at `frame`, the reference frame being `reference_frame`:
// circles -> homography; the patches' displacement added AT THE CIRCLES -> second homography -> target.
[[nodiscard]] Extent<frame::Board> exact_error(const simulator::Scenario& scenario, long frame, long reference_frame,
                                               Stages stages);

}  // namespace moiregauge::internal::test
