// SPDX-License-Identifier: Apache-2.0
// The whole pitch of a print that shows no outline and has no circle follows from continuity alone.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/calibration/scene/frame_series.h"
#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

// Pitches from one reading to the next up to which continuity gives the whole pitch.
inline constexpr double kSureOfOrder = 0.25;

// One per site marker: does a target go more than a quarter of a pitch between any two frames that show it? Then it may
// as well go more than half of one, which continuity takes for less in the other direction.
[[nodiscard]] std::vector<bool> outruns_continuity(const Site& site, std::span<const FrameStart> frames);

// Of samples whose whole pitch follows from continuity alone (`two-stage`, frame by frame): those of a target from the
// first one on that stands more than a quarter of a pitch from the one before.
void doubt_after_leaps(const Site& site, std::span<Sample> samples);

}  // namespace moiregauge::internal
