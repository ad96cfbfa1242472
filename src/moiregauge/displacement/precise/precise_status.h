// SPDX-License-Identifier: Apache-2.0
// The status word of a row of `precise`.
#pragma once

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// A frame whose patches lie this many times further from the scene than their noise explains is no longer an
// uncertainty one can state: something moved, or the shutter rolls.
inline constexpr double kUntrustedChi2 = 25.0;

// Of target `i` in what was `seen`, against the scene fitted to that frame; beyond `untrusted_chi2` per degree of
// freedom the frame does not lie in the scene.
[[nodiscard]] Status precise_status(const Reference& reference, const Observation& seen, std::size_t i,
                                    const FrameFit& fit, double untrusted_chi2);

}  // namespace moiregauge::internal
