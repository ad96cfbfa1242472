// SPDX-License-Identifier: Apache-2.0
// Fringe order by continuity, for gratings without an outline and without a circle.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/calibration/scene/frame_series.h"
#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

// Largest step between two readings for which continuity gives the fringe order, pitches. Half a pitch is ambiguous;
// the rest is margin. Chosen.
inline constexpr double kSureOfOrder = 0.25;

// Returns true for targets that move more than kSureOfOrder between two of their frames, one per site marker. Such a
// target may also have moved the other way.
[[nodiscard]] std::vector<bool> outruns_continuity(const Site& site, std::span<const FrameStart> frames);

// Marks samples whose fringe order follows from continuity alone (`two-stage`) as kOrderUnproven, with NaN values. It
// affects each target from its first step above kSureOfOrder.
void doubt_after_leaps(const Site& site, std::span<Sample> samples);

}  // namespace moiregauge::internal
