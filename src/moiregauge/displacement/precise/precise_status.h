// SPDX-License-Identifier: Apache-2.0
// Status of a row of `precise`.
#pragma once

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// chi2 per degree of freedom above which a frame does not belong to the scene and is `untrusted`. Something moved, or
// the shutter rolls. Chosen.
inline constexpr double kUntrustedChi2 = 25.0;

// Returns the status of target `i` in one frame, fitted to the scene. Above `untrusted_chi2` per degree of freedom the
// row is kUntrusted.
[[nodiscard]] Status precise_status(const Reference& reference, const Observation& seen, std::size_t i,
                                    const FrameFit& fit, double untrusted_chi2);

}  // namespace moiregauge::internal
